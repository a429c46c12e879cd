#include "backends/vulkan/raster/raster_target.h"

#include <algorithm>

#include "backends/vulkan/device/device.h"

namespace tessera::vulkan {

namespace {

constexpr std::size_t MostWaiting = 4;  // more units at a time than any node has on one device

}  // namespace

RasterTarget::RasterTarget(Device& device, std::uint32_t width, std::uint32_t height, std::uint32_t count)
    : instances(count),
      ids(device, Image::Kind::Ids, width, height),
      depth(device, Image::Kind::Depth, width, height),
      draws(device, std::uint64_t{count} * sizeof(VkDrawIndirectCommand)),
      seen(device, std::uint64_t{count} * sizeof(std::uint32_t)) {
    device.queue().submit(Fill{&seen, 0, seen.size(), 0});
}

RasterTargets::Lease RasterTargets::take(std::uint32_t width, std::uint32_t height, std::uint32_t instances) {
    std::unique_ptr<RasterTarget> target;
    {
        const std::scoped_lock lock(mutex_);
        std::erase_if(free_, [&](const auto& waiting) {
            return waiting->ids.width() != width || waiting->ids.height() != height ||
                   waiting->instances != instances;
        });
        if (!free_.empty()) {
            target = std::move(free_.back());
            free_.pop_back();
        }
    }
    if (target == nullptr) target = std::make_unique<RasterTarget>(device_, width, height, instances);
    return Lease(*this, std::move(target));
}

RasterTargets::Lease::~Lease() {
    const std::scoped_lock lock(owner_.mutex_);
    if (owner_.free_.size() < MostWaiting) owner_.free_.push_back(std::move(target_));
}

}  // namespace tessera::vulkan
