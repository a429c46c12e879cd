#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "backends/vulkan/device/buffer.h"
#include "backends/vulkan/device/image.h"

namespace tessera::vulkan {

// What one unit at a time draws into.
struct RasterTarget {
    // Images of what a picture of this size can touch of a cell.
    RasterTarget(Device& device, std::uint32_t width, std::uint32_t height, std::uint32_t instances);

    std::uint32_t instances;
    Image ids, depth;
    Buffer draws;   // VkDrawIndirectCommand, the last instance first
    Buffer seen;    // a number each instance: unhidden the last time, wherever that was
    Buffer depths;  // of an area, with its pyramid; grows
};

// Targets that wait for the next unit. What they know of the last time saves work; the picture does not
// depend on it. Thread-safe.
class RasterTargets final {
  public:
    explicit RasterTargets(Device& device) : device_(device) {}

    class Lease;
    // One that is free, or a new one. Throws Error{OutOfMemory} and DeviceLost.
    Lease take(std::uint32_t width, std::uint32_t height, std::uint32_t instances);

  private:
    Device& device_;
    std::mutex mutex_;  // protects:
    std::vector<std::unique_ptr<RasterTarget>> free_;
};

// A target until it goes back. What still draws into it is ordered before whoever has it next.
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
