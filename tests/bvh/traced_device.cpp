#include "tests/bvh/traced_device.h"

#include "tests/bvh/trace_address.comp.h"
#include "tests/bvh/trace_plain.comp.h"
#include "tests/bvh/trace_texels.comp.h"

namespace tessera::vulkan {

namespace {

constexpr std::uint32_t GroupSize = 64;

// As in trace.comp.
struct AskedRay {
    glm::vec3 origin;
    float near;
    glm::vec3 direction;
    float far;
};

struct PushedArguments {
    std::uint64_t pool, rays, hits;
    std::uint32_t top, count;
};

std::vector<AskedRay> asked(std::span<const TestRay> rays) {
    std::vector<AskedRay> all;
    for (const TestRay& ray : rays) all.push_back({ray.origin, ray.near, ray.direction, ray.far});
    return all;
}

PipelineSettings settings(Traversal traversal, std::uint32_t question) {
    PipelineSettings made{.constants = {{0, question}}, .push_bytes = sizeof(PushedArguments)};
    if (traversal == Traversal::Plain) {
        made.name = "trace plain trees";
        made.code = shaders::trace_plain_comp();
    } else if (traversal == Traversal::Address) {
        made.name = "trace by address";
        made.code = shaders::trace_address_comp();
    } else {
        made.name = "trace as texels";
        made.code = shaders::trace_texels_comp();
        made.bindings = {{0, Binding::Kind::Texels}, {1, Binding::Kind::Texels}, {2, Binding::Kind::Storage}};
    }
    return made;
}

}  // namespace

TracedDevice::TracedDevice(Device& device, const TracedScene& scene, std::span<const TestRay> rays,
                           Traversal traversal, std::uint32_t question)
    : device_(device),
      pool_(make_buffer(device, traversal == Traversal::Plain ? scene.plain_pool() : scene.pool())),
      rays_(make_buffer(device, asked(rays))),
      hits_(device, rays.size() * sizeof(shading::Hit)),
      pipeline_(device, settings(traversal, question)) {
    const auto count = static_cast<std::uint32_t>(rays.size());
    const std::uint32_t top = traversal == Traversal::Plain ? scene.plain_top_place() : scene.top_place();
    pass_ = {.pipeline = &pipeline_,
             .arguments = PushedArguments{pool_.address(), rays_.address(), hits_.address(), top, count},
             .groups = {(count + GroupSize - 1) / GroupSize},
             .writes = {&hits_}};
    if (traversal == Traversal::Texels) pass_.bound = {&pool_, &rays_, &hits_};
}

}  // namespace tessera::vulkan
