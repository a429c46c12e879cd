#include "backends/vulkan/raster/raster_kernels.h"

#include <algorithm>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/raster/raster_jobs.h"
#include "backends/vulkan/shaders/raster.frag.h"
#include "backends/vulkan/shaders/raster.vert.h"
#include "backends/vulkan/shaders/raster_cull.comp.h"
#include "backends/vulkan/shaders/raster_pyramid.comp.h"
#include "mediator/shading/records.h"

namespace tessera::vulkan {

RasterKernels::RasterKernels(Device& device)
    : device_(device), group_size_(std::min(64u, device.info().max_workgroup_size)) {}

RasterKernels::Set RasterKernels::find(std::uint32_t features) {
    features |= ~shading::FeatureAlpha;  // nothing else is asked for
    const std::scoped_lock lock(mutex_);
    if (cull_ == nullptr) {
        cull_ =
            std::make_unique<ComputePipeline>(device_, PipelineSettings{.name = "culling",
                                                                        .code = shaders::raster_cull_comp(),
                                                                        .constants = {{0, group_size_}},
                                                                        .push_bytes = sizeof(CullJob)});
        pyramid_ = std::make_unique<ComputePipeline>(device_,
                                                     PipelineSettings{.name = "the pyramid of depths",
                                                                      .code = shaders::raster_pyramid_comp(),
                                                                      .constants = {{0, group_size_}},
                                                                      .push_bytes = sizeof(PyramidJob)});
    }
    std::unique_ptr<GraphicsPipeline>& draw = draws_[features];
    if (draw == nullptr) {
        draw =
            std::make_unique<GraphicsPipeline>(device_, GraphicsSettings{.name = "drawing",
                                                                         .vertex = shaders::raster_vert(),
                                                                         .fragment = shaders::raster_frag(),
                                                                         .constants = {{1, features}},
                                                                         .push_bytes = sizeof(DrawJob)});
    }
    return {*draw, *cull_, *pyramid_, group_size_};
}

}  // namespace tessera::vulkan
