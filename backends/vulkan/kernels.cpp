#include "backends/vulkan/kernels.h"

#include <algorithm>
#include <utility>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/job.h"
#include "backends/vulkan/shaders/merge.comp.h"
#include "backends/vulkan/shaders/trace.comp.h"
#include "backends/vulkan/shaders/trace_bvh2.comp.h"
#include "backends/vulkan/shaders/trace_raster.comp.h"
#include "backends/vulkan/shaders/trace_raster_texels.comp.h"
#include "backends/vulkan/shaders/trace_texels.comp.h"
#include "backends/vulkan/shaders/trace_trees.comp.h"
#include "backends/vulkan/shaders/trace_trees_texels.comp.h"
#include "mediator/shading/records.h"

namespace tessera::vulkan {

namespace {

std::span<const std::uint32_t> code_of(const KernelVariant& kind) {
    const bool texels = kind.traversal == Traversal::Texels;
    if (kind.traversal == Traversal::Bvh2) return shaders::trace_bvh2_comp();
    if (kind.rasterised) return texels ? shaders::trace_raster_texels_comp() : shaders::trace_raster_comp();
    if (kind.specular_trees) {
        return texels ? shaders::trace_trees_texels_comp() : shaders::trace_trees_comp();
    }
    return texels ? shaders::trace_texels_comp() : shaders::trace_comp();
}

Kernel compile_async(Device& device, PipelineSettings settings) {
    return std::async(std::launch::async, [&device, settings = std::move(settings)] {
        return ComputePipeline(device, settings);
    });
}

}  // namespace

// 64 is a multiple of every known subgroup size, and small enough for kernels with many registers.
Kernels::Kernels(Device& device)
    : device_(device), group_size_(std::min(64u, device.info().max_workgroup_size)) {}

// Specialised for exactly the features of the scene: without code for textures and lights that it lacks, the
// kernel loads half as much, which lavapipe does lane by lane (1.1 to 1.25 times the samples). An edit that adds the
// first light of a kind waits once for the driver's compiler.
Kernel Kernels::find(KernelVariant kind) {
    const std::scoped_lock lock(mutex_);
    Kernel& kernel = trace_kernels_[kind];
    if (!kernel.valid()) {
        PipelineSettings settings{.name = kind.rasterised ? "shading" : "path tracing",
                                  .code = code_of(kind),
                                  .constants = {{0, group_size_}, {1, kind.features}},
                                  .push_bytes = sizeof(Job)};
        if (kind.traversal == Traversal::Texels)
            settings.bindings = {{.index = 0, .kind = Binding::Kind::Texels}};
        kernel = compile_async(device_, std::move(settings));
    }
    return kernel;
}

Kernel Kernels::merge_kernel() {
    const std::scoped_lock lock(mutex_);
    if (!merge_kernel_.valid()) {
        merge_kernel_ = compile_async(device_, {.name = "sample merge",
                                                .code = shaders::merge_comp(),
                                                .constants = {{0, group_size_}},
                                                .push_bytes = sizeof(MergeJob)});
    }
    return merge_kernel_;
}

}  // namespace tessera::vulkan
