#include "backends/embree/alpha.h"

#include "backends/embree/scene_tables.h"
#include "mediator/shading/sobol.h"

namespace tessera::embree {

void alpha_filter(const RTCFilterFunctionNArguments* arguments) {
    const auto* context = reinterpret_cast<const TraceContext*>(arguments->context);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] == 0) continue;
        const std::uint32_t instance = RTCHitN_instID(arguments->hit, arguments->N, i, 0);
        const std::uint32_t triangle = RTCHitN_primID(arguments->hit, arguments->N, i);
        const glm::vec2 barycentric{RTCHitN_u(arguments->hit, arguments->N, i),
                                    RTCHitN_v(arguments->hit, arguments->N, i)};
        const InstanceData& data = context->tables->instances[instance];
        const MaterialData& material = context->tables->materials[data.material];
        const float alpha = alpha_at(*context->tables, data, triangle, barycentric);
        bool stops = alpha >= material.alpha_cutoff;
        if (material.alpha_mode == scene::AlphaMode::Blend) {
            const std::uint32_t hash =
                shading::hash_combine(shading::hash_combine(context->seed, instance), triangle);
            stops = shading::unit_float(hash) < alpha;
        }
        if (!stops) arguments->valid[i] = 0;
    }
}

}  // namespace tessera::embree
