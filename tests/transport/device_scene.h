#pragma once

#include <vector>

#include "backends/vulkan/device/buffer.h"
#include "mediator/backend/tables/tables.h"

namespace tessera::vulkan {

// The tables of a scene on a device, each array in a buffer of its own.
class DeviceScene {
  public:
    DeviceScene(Device& device, backend::SceneTables tables);

    const shading::Scene& record() const { return record_; }

  private:
    std::vector<Buffer> buffers_;
    shading::Scene record_{};
};

}  // namespace tessera::vulkan
