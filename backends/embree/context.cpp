#include "backends/embree/context.h"

#include <cstdio>
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

std::string text(const glm::vec3& v) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, "(%.9g, %.9g, %.9g)", double(v.x), double(v.y), double(v.z));
    return buffer;
}

}  // namespace

bool trace_closest(const Context& context, const shading::Ray& ray, std::uint32_t seed, shading::Hit& hit) {
    TraceContext started = start(context, seed);
    RTCRayHit query;
    query.ray = {ray.origin.x,
                 ray.origin.y,
                 ray.origin.z,
                 shading::NearestHit,
                 ray.direction.x,
                 ray.direction.y,
                 ray.direction.z,
                 0.0f,
                 std::numeric_limits<float>::infinity(),
                 ~0u,
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
    RTCRay ray{origin.x, origin.y, origin.z, shading::NearestHit, segment.x, segment.y, segment.z, 0.0f, far,
               ~0u,      0,        0};
    rtcOccluded1(context.top, &started.embree, &ray);
    return ray.tfar < 0.0f;
}

void write_camera(std::vector<std::string>& story, const shading::Ray& ray) {
    story.push_back("camera " + text(ray.origin) + " looks along " + text(ray.direction));
}

void write_hit(std::vector<std::string>& story, const shading::Surface& surface,
               const glm::vec3& throughput) {
    story.push_back("hits object " + std::to_string(surface.object) + " triangle " +
                    std::to_string(surface.triangle) + " at " + text(surface.position) + " with normal " +
                    text(surface.frame[2]) + ", carries " + text(throughput));
}

void write_miss(std::vector<std::string>& story) {
    story.push_back("leaves the scene");
}

void write_emission(std::vector<std::string>& story, const glm::vec3& emission, const glm::vec3& direction) {
    story.push_back("  sees emission " + text(emission) + " along " + text(direction));
}

void write_light(std::vector<std::string>& story, const glm::vec3& direction, const glm::vec3& gathered) {
    story.push_back("  light " + text(direction) + " adds " + text(gathered));
}

void write_specular(std::vector<std::string>& story, bool reflects, const glm::vec3& direction) {
    story.push_back((reflects ? "  reflected to " : "  refracted to ") + text(direction));
}

}  // namespace tessera::embree
