#pragma once

#include <vector>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/gpu_scene.h"
#include "backends/vulkan/raster/raster_kernels.h"
#include "backends/vulkan/raster/raster_target.h"
#include "mediator/base/rect.h"

namespace tessera::vulkan {

struct RasterSettings {
    // Whether invisible instances are culled; the picture is the same. Occlusion culling is used from
    // `occlusion_min_instances` instances on: it costs drawing the previously visible instances twice.
    enum class Culling { Off, On } culling = Culling::On;
    std::uint32_t occlusion_min_instances = 64;
    std::uint32_t draws_per_call = 0xffffffffu;  // at most; fewer where the device supports fewer
};

// Rasterises the visible triangle of each pixel of a tile. The view's record is on the device at `view_address`.
// All referenced objects outlive the steps.
struct RasterPass {
    Device& device;
    const RasterKernels::Set& kernels;
    const GpuScene& scene;
    RasterTarget& target;
    const RasterSettings& settings;
    const shading::View& view;
    std::uint64_t view_address;

    // Appends the steps of one sample: afterwards `seen` has instance and triangle of the tile's pixels, two
    // numbers each (NoInstance and 0: nothing), from byte `offset` on. Throws Error{OutOfMemory}.
    void add_steps(std::vector<Step>& steps, const Rect& tile, std::uint64_t index, const Buffer& seen,
                   std::uint64_t offset) const;
};

}  // namespace tessera::vulkan
