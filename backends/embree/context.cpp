#include "backends/embree/context.h"

#include <limits>

#include "backends/embree/alpha.h"

namespace tessera::embree {

namespace {

TraceContext start(const Context& context, std::uint32_t seed) {
    TraceContext started;
    rtcInitIntersectContext(&started.embree);
    started.scene = &context.scene;
    started.seed = seed;
    return started;
}

}  // namespace

bool trace_closest(const Context& context, const shading::Ray& ray, std::uint32_t seed,
                   const shading::Skip& skip, shading::Hit& hit) {
    TraceContext started = start(context, seed);
    started.skip = skip;
    RTCRayHit query;
    query.ray = {ray.origin.x,
                 ray.origin.y,
                 ray.origin.z,
                 skip.near,
                 ray.direction.x,
                 ray.direction.y,
                 ray.direction.z,
                 context.time,
                 std::numeric_limits<float>::infinity(),
                 context.view.layers,
                 0,
                 0};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(context.top, &started.embree, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit = {query.hit.instID[0], query.hit.primID, {query.hit.u, query.hit.v}, query.ray.tfar};
    return true;
}

bool trace_occluded(const Context& context, const glm::vec3& origin, const glm::vec3& segment, float far,
                    std::uint32_t seed) {
    TraceContext started = start(context, seed);
    RTCRay ray{origin.x,  origin.y,     origin.z, shading::NearestHit, segment.x, segment.y,
               segment.z, context.time, far,      context.view.layers, 0,         0};
    rtcOccluded1(context.top, &started.embree, &ray);
    return ray.tfar < 0.0f;
}

}  // namespace tessera::embree
