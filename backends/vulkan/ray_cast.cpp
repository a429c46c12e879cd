#include "backends/vulkan/ray_cast.h"

#include "backends/vulkan/shaders/rays_address.comp.h"
#include "backends/vulkan/shaders/rays_bvh2.comp.h"
#include "backends/vulkan/shaders/rays_texels.comp.h"

namespace tessera::vulkan {

namespace {

constexpr std::uint32_t GroupSize = 64;

// As in rays.comp.
struct PushedArguments {
    std::uint64_t pool, rays, hits;
    std::uint32_t top, count;
};

PipelineSettings pipeline_for(const CastSettings& settings) {
    PipelineSettings result{.constants = {{0, settings.question}, {1, settings.passes_every}},
                            .push_bytes = sizeof(PushedArguments)};
    if (settings.traversal == Traversal::Bvh2) {
        result.name = "rays through binary BVHs";
        result.code = shaders::rays_bvh2_comp();
    } else if (settings.traversal == Traversal::Address) {
        result.name = "rays by address";
        result.code = shaders::rays_address_comp();
    } else {
        result.name = "rays through texels";
        result.code = shaders::rays_texels_comp();
        result.bindings = {
            {0, Binding::Kind::Texels}, {1, Binding::Kind::Texels}, {2, Binding::Kind::Storage}};
    }
    return result;
}

Buffer rays_on(Device& device, std::span<const shading::RayQuery> rays) {
    Buffer buffer(device, rays.size_bytes());
    upload_bytes(device, buffer, std::as_bytes(rays));
    return buffer;
}

}  // namespace

RayCast::RayCast(Device& device, const Buffer& pool, std::uint32_t top,
                 std::span<const shading::RayQuery> rays, const CastSettings& settings)
    : device_(device),
      rays_(rays_on(device, rays)),
      hits_(device, rays.size() * sizeof(shading::Hit)),
      pipeline_(device, pipeline_for(settings)) {
    const auto count = static_cast<std::uint32_t>(rays.size());
    dispatch_ = {.pipeline = &pipeline_,
                 .arguments = PushedArguments{pool.address(), rays_.address(), hits_.address(), top, count},
                 .groups = {(count + GroupSize - 1) / GroupSize},
                 .writes = {&hits_}};
    if (settings.traversal == Traversal::Texels) dispatch_.bound = {&pool, &rays_, &hits_};
}

}  // namespace tessera::vulkan
