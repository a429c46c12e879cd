#include "backends/vulkan/kernels.h"

#include <algorithm>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/job.h"
#include "backends/vulkan/shaders/merge.comp.h"
#include "backends/vulkan/shaders/trace.comp.h"
#include "backends/vulkan/shaders/trace_plain.comp.h"
#include "backends/vulkan/shaders/trace_raster.comp.h"
#include "backends/vulkan/shaders/trace_raster_texels.comp.h"
#include "backends/vulkan/shaders/trace_texels.comp.h"
#include "backends/vulkan/shaders/trace_trees.comp.h"
#include "backends/vulkan/shaders/trace_trees_texels.comp.h"
#include "mediator/shading/records.h"

namespace tessera::vulkan {

namespace {

std::span<const std::uint32_t> code_of(const KernelKind& kind) {
    const bool texels = kind.traversal == Traversal::Texels;
    if (kind.traversal == Traversal::Plain) return shaders::trace_plain_comp();
    if (kind.rasterised) return texels ? shaders::trace_raster_texels_comp() : shaders::trace_raster_comp();
    if (kind.specular_trees) {
        return texels ? shaders::trace_trees_texels_comp() : shaders::trace_trees_comp();
    }
    return texels ? shaders::trace_texels_comp() : shaders::trace_comp();
}

// What the text asks about. The rest is no smaller without, and each mask costs a driver seconds.
constexpr std::uint32_t Pruned = shading::FeatureAlpha | shading::FeatureSpecular |
                                 shading::FeatureMeshLights | shading::FeatureEnvironmentMap;

}  // namespace

// 64 is a multiple of every subgroup there is, and small enough for kernels with many registers.
Kernels::Kernels(Device& device)
    : device_(device), group_size_(std::min(64u, device.info().max_workgroup_size)) {}

const ComputePipeline& Kernels::find(KernelKind kind) {
    kind.features |= ~Pruned;
    const std::scoped_lock lock(mutex_);
    std::unique_ptr<ComputePipeline>& kernel = made_[kind];
    if (!kernel) {
        PipelineSettings settings{.name = kind.rasterised ? "shading" : "path tracing",
                                  .code = code_of(kind),
                                  .constants = {{0, group_size_}, {1, kind.features}},
                                  .push_bytes = sizeof(Job)};
        if (kind.traversal == Traversal::Texels)
            settings.bindings = {{.index = 0, .kind = Binding::Kind::Texels}};
        kernel = std::make_unique<ComputePipeline>(device_, settings);
    }
    return *kernel;
}

const ComputePipeline& Kernels::merging() {
    const std::scoped_lock lock(mutex_);
    if (!merging_) {
        merging_ =
            std::make_unique<ComputePipeline>(device_, PipelineSettings{.name = "merging of samples",
                                                                        .code = shaders::merge_comp(),
                                                                        .constants = {{0, group_size_}},
                                                                        .push_bytes = sizeof(MergeJob)});
    }
    return *merging_;
}

}  // namespace tessera::vulkan
