#include "backends/embree/ray_caster.h"

#include <limits>

#include "backends/embree/alpha.h"

namespace tessera::embree {

namespace {

constexpr float Infinity = std::numeric_limits<float>::infinity();
// Where the error bound is zero (an axis-aligned plane through the origin) a path starts on the surface
// exactly: only a hit at distance 0 has to be kept out.
constexpr float Near = std::numeric_limits<float>::min();

}  // namespace

std::optional<Hit> RayCaster::closest(const Ray& ray, std::uint32_t seed) const {
    TraceContext context;
    rtcInitIntersectContext(&context.embree);
    context.tables = &tables_;
    context.seed = seed;
    RTCRayHit query;
    query.ray = {ray.origin.x,
                 ray.origin.y,
                 ray.origin.z,
                 Near,
                 ray.direction.x,
                 ray.direction.y,
                 ray.direction.z,
                 0.0f,
                 Infinity,
                 ~0u,
                 0,
                 0};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context.embree, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Hit{query.hit, query.ray.tfar};
}

bool RayCaster::occluded(const glm::vec3& origin, const glm::vec3& segment, float far,
                         std::uint32_t seed) const {
    TraceContext context;
    rtcInitIntersectContext(&context.embree);
    context.tables = &tables_;
    context.seed = seed;
    RTCRay ray{origin.x, origin.y, origin.z, Near, segment.x, segment.y, segment.z, 0.0f, far, ~0u, 0, 0};
    rtcOccluded1(scene_, &context.embree, &ray);
    return ray.tfar < 0.0f;
}

}  // namespace tessera::embree
