#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "backends/vulkan/device/buffer.h"
#include "backends/vulkan/device/image.h"

namespace tessera::vulkan {

// Render targets of one unit at a time.
struct RasterTarget {
    // Images that cover the part of a cell that a picture of this size can touch.
    RasterTarget(Device& device, std::uint32_t width, std::uint32_t height, std::uint32_t instances);

    std::uint32_t instances;
    Image ids, depth;
    Buffer draws;   // VkDrawIndirectCommand, the last instance first
    Buffer seen;    // per instance: 1 if it was visible the last time, in any tile
    Buffer depths;  // of an area, with its depth pyramid; grows
};

// Free targets for the next units. Visibility of the previous frame saves work; the picture does not depend on
// it. Thread-safe.
class RasterTargets final {
  public:
    explicit RasterTargets(Device& device) : device_(device) {}

    class Lease;
    // A free target, or a new one. Throws Error{OutOfMemory} and DeviceLost.
    Lease take(std::uint32_t width, std::uint32_t height, std::uint32_t instances);

  private:
    Device& device_;
    std::mutex mutex_;  // protects:
    std::vector<std::unique_ptr<RasterTarget>> free_;
};

// A target until it is returned. Pending draws into it are ordered before those of its next user.
class RasterTargets::Lease final {
  public:
    Lease(RasterTargets& owner, std::unique_ptr<RasterTarget> target)
        : owner_(owner), target_(std::move(target)) {}
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease();

    RasterTarget& operator*() const { return *target_; }
    RasterTarget* operator->() const { return target_.get(); }

  private:
    RasterTargets& owner_;
    std::unique_ptr<RasterTarget> target_;
};

}  // namespace tessera::vulkan
