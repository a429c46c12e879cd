#pragma once

#include <stop_token>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/dispatch_budget.h"
#include "backends/vulkan/gpu_scene.h"
#include "backends/vulkan/kernels.h"
#include "backends/vulkan/raster/raster_run.h"
#include "mediator/backend/backend.h"

namespace tessera::vulkan {

// Traces the samples of a unit in dispatches of adaptive size, two in flight at a time, and merges them
// in the canonical order: on the device where a dispatch has several samples of the whole tile, else on the
// host. Throws DeviceLost.
struct TileRenderer {
    Device& device;
    Kernels& kernels;
    DispatchBudget& dispatch_budget;
    const GpuScene& scene;
    std::uint32_t features = 0;                     // of the scene for the view (backend::features_for)
    const RasterTools* raster = nullptr;            // for rasterised first hits (view::Renderer::Raster)
    std::vector<shading::Affine3x4> camera_keys{};  // of a moving camera

    backend::RenderResult run(const shading::View& view, const view::WorkUnit& unit,
                              frame::ChannelSet channels, const std::stop_token& stop) const;
};

}  // namespace tessera::vulkan
