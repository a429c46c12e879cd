#include "backends/embree/rays.h"

#include <limits>

#include "backends/embree/alpha.h"

namespace tessera::embree {

namespace {

TraceContext start(const Rays& rays, const shading::Sampler& numbers) {
    TraceContext started;
    rtcInitIntersectContext(&started.embree);
    started.scene = &rays.scene;
    started.numbers = numbers;
    return started;
}

}  // namespace

bool trace_closest(const Rays& rays, const shading::Ray& ray, const shading::Sampler& numbers,
                   const shading::Skip& skip, shading::Hit& hit) {
    TraceContext started = start(rays, numbers);
    started.skip = skip;
    RTCRayHit query;
    query.ray = {ray.origin.x,
                 ray.origin.y,
                 ray.origin.z,
                 skip.near,
                 ray.direction.x,
                 ray.direction.y,
                 ray.direction.z,
                 rays.time,
                 std::numeric_limits<float>::infinity(),
                 rays.view.layers,
                 0,
                 0};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(rays.top, &started.embree, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit = {query.hit.instID[0], query.hit.primID, {query.hit.u, query.hit.v}, query.ray.tfar};
    return true;
}

bool trace_occluded(const Rays& rays, const glm::vec3& origin, const glm::vec3& segment, float far,
                    const shading::Sampler& numbers, shading::ThinWalls& walls) {
    TraceContext started = start(rays, numbers);
    walls = shading::no_thin_walls();
    started.walls = &walls;
    started.skip.unlit = true;
    RTCRay ray{origin.x,  origin.y,  origin.z, shading::NearestHit, segment.x, segment.y,
               segment.z, rays.time, far,      rays.view.layers,    0,         0};
    rtcOccluded1(rays.top, &started.embree, &ray);
    return ray.tfar < 0.0f;
}

}  // namespace tessera::embree
