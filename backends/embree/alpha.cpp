#include "backends/embree/alpha.h"

#include "mediator/shading/materials.h"

namespace tessera::embree {

void alpha_filter(const RTCFilterFunctionNArguments* arguments) {
    const auto* context = reinterpret_cast<const TraceContext*>(arguments->context);
    const unsigned count = arguments->N;
    for (unsigned i = 0; i < count; ++i) {
        if (arguments->valid[i] == 0) continue;
        const std::uint32_t instance = RTCHitN_instID(arguments->hit, count, i, 0);
        const std::uint32_t triangle = RTCHitN_primID(arguments->hit, count, i);
        const glm::vec2 barycentric{RTCHitN_u(arguments->hit, count, i), RTCHitN_v(arguments->hit, count, i)};
        const float distance = RTCRayN_tfar(arguments->ray, count, i);
        const bool passes = shading::skips(context->skip, instance, distance) ||
                            !shading::stops_at(*context->scene, context->skip, instance, triangle,
                                               barycentric, context->numbers);
        const bool is_wall =
            !passes && context->walls != nullptr && shading::is_thin_wall(*context->scene, instance);
        if (is_wall) shading::meet_thin_wall(*context->walls, {instance, triangle, barycentric, distance});
        if (passes || is_wall) arguments->valid[i] = 0;
    }
}

}  // namespace tessera::embree
