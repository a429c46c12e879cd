#pragma once

#include <array>
#include <vector>

#include "backends/vulkan/raster/raster_pass.h"

namespace tessera::vulkan {

// What rasterising has on a device, for all units, and how it is to be done.
struct RasterTools {
    RasterKernels& kernels;
    RasterTargets& targets;
    RasterSettings settings;
};

// The drawing of one unit's samples.
class RasterRun final {
  public:
    static constexpr std::uint32_t MostSamples = 64;  // in one submission

    // The view's record is on the device at `view_address`, as long as this and what it submitted. Throws
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
    std::array<Buffer, 2> seen_;  // some are shaded while the next ones are drawn
    std::size_t current_ = 0;
};

}  // namespace tessera::vulkan
