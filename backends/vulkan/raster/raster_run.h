#pragma once

#include <array>
#include <vector>

#include "backends/vulkan/raster/raster_pass.h"

namespace tessera::vulkan {

// Resources of the rasteriser on a device, shared by all units, and its settings.
struct RasterTools {
    RasterKernels& kernels;
    RasterTargets& targets;
    RasterSettings settings;
};

// The drawing of one unit's samples.
class RasterRun final {
  public:
    static constexpr std::uint32_t MaxSamples = 64;  // in one submission

    // The view's record is on the device at `view_address`, for the lifetime of this object and its submissions. Throws
    // Error{OutOfMemory} and DeviceLost.
    RasterRun(Device& device, const RasterTools& tools, const GpuScene& scene, const shading::View& view,
              std::uint64_t view_address, const Rect& tile);

    // Appends the steps that draw these samples.
    void draw(std::vector<Step>& steps, std::uint64_t first, std::uint32_t count);
    // Instance and triangle of each pixel of the samples drawn last, sample after sample.
    const Buffer& seen() const { return seen_[current_]; }

  private:
    Device& device_;
    RasterKernels::Set kernels_;
    RasterTargets::Lease target_;
    RasterSettings settings_;
    shading::View view_;
    RasterPass pass_;
    Rect tile_;
    std::array<Buffer, 2> seen_;  // double-buffered: one is shaded while the next is drawn
    std::size_t current_ = 0;
};

}  // namespace tessera::vulkan
