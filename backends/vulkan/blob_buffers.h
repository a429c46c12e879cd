#pragma once

#include <map>

#include "backends/vulkan/device/buffer.h"
#include "mediator/scene/blob.h"

namespace tessera::vulkan {

// The blobs that scene records point into, one buffer per blob on the device.
class BlobBuffers final {
  public:
    explicit BlobBuffers(Device& device) : device_(device) {}

    // The device address of the blob, which is uploaded if it is new. Throws Error{OutOfMemory} with the sizes.
    std::uint64_t address_of(const scene::BlobPtr& blob);
    // Drops all blobs that were not requested since the previous call.
    void drop_unused();

  private:
    struct Entry {
        Buffer buffer;
        bool used = false;
    };
    Device& device_;
    std::map<Hash256, Entry> entries_;
};

}  // namespace tessera::vulkan
