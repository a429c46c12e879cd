#include "backends/vulkan/kernels.h"

#include <algorithm>
#include <utility>

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

Kernel made(Device& device, PipelineSettings settings) {
    return std::async(std::launch::async, [&device, settings = std::move(settings)] {
        return ComputePipeline(device, settings);
    });
}

}  // namespace

// 64 is a multiple of every subgroup there is, and small enough for kernels with many registers.
Kernels::Kernels(Device& device)
    : device_(device), group_size_(std::min(64u, device.info().max_workgroup_size)) {}

// Made for exactly what the scene has: without textures and kinds of lights that it lacks, the shared code
// loads half as much, which lavapipe does lane by lane (1.1 to 1.25 times the samples). An edit that brings a
// scene its first light of a kind waits for the driver once.
Kernel Kernels::find(KernelKind kind) {
    const std::scoped_lock lock(mutex_);
    Kernel& kernel = made_[kind];
    if (!kernel.valid()) {
        PipelineSettings settings{.name = kind.rasterised ? "shading" : "path tracing",
                                  .code = code_of(kind),
                                  .constants = {{0, group_size_}, {1, kind.features}},
                                  .push_bytes = sizeof(Job)};
        if (kind.traversal == Traversal::Texels)
            settings.bindings = {{.index = 0, .kind = Binding::Kind::Texels}};
        kernel = made(device_, std::move(settings));
    }
    return kernel;
}

Kernel Kernels::merging() {
    const std::scoped_lock lock(mutex_);
    if (!merging_.valid()) {
        merging_ = made(device_, {.name = "merging of samples",
                                  .code = shaders::merge_comp(),
                                  .constants = {{0, group_size_}},
                                  .push_bytes = sizeof(MergeJob)});
    }
    return merging_;
}

}  // namespace tessera::vulkan
