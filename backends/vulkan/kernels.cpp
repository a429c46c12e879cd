#include "backends/vulkan/kernels.h"

#include <algorithm>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/job.h"
#include "backends/vulkan/shaders/trace_addresses.comp.h"
#include "backends/vulkan/shaders/trace_texels.comp.h"

namespace tessera::vulkan {

KernelKind kind_of(std::uint32_t features, const shading::View& view) {
    return {features, view.channels, view.keeps, view.renderer, view.pixel_filter};
}

// 64 is a multiple of every subgroup there is, and small enough for kernels with many registers.
Kernels::Kernels(Device& device)
    : device_(device), group_size_(std::min(64u, device.info().max_workgroup_size)) {}

const ComputePipeline& Kernels::find(const KernelKind& kind, PoolAccess access) {
    const std::scoped_lock lock(mutex_);
    std::unique_ptr<ComputePipeline>& kernel = made_[{kind, access}];
    if (!kernel) {
        const bool texels = access == PoolAccess::Texels;
        PipelineSettings settings{
            .name = "path tracing",
            .code = texels ? shaders::trace_texels_comp() : shaders::trace_addresses_comp(),
            .constants = {{0, group_size_},
                          {1, kind.features},
                          {2, kind.channels},
                          {3, kind.keeps},
                          {4, kind.renderer},
                          {5, kind.pixel_filter}},
            .push_bytes = sizeof(Job)};
        if (texels) settings.bindings = {{.index = 0, .kind = Binding::Kind::Texels}};
        kernel = std::make_unique<ComputePipeline>(device_, settings);
    }
    return *kernel;
}

}  // namespace tessera::vulkan
