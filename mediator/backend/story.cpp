#include "mediator/backend/story.h"

#include <cstdio>

namespace tessera::backend {

namespace {

std::string text(const glm::vec3& v) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, "(%.9g, %.9g, %.9g)", double(v.x), double(v.y), double(v.z));
    return buffer;
}

}  // namespace

void write_camera(Story& story, const shading::Ray& ray) {
    story.push_back("camera " + text(ray.origin) + " looks along " + text(ray.direction));
}

void write_hit(Story& story, const shading::Surface& surface, const glm::vec3& throughput) {
    story.push_back("hits object " + std::to_string(surface.object) + " triangle " +
                    std::to_string(surface.triangle) + " at " + text(surface.position) + " with normal " +
                    text(surface.frame[2]) + ", carries " + text(throughput));
}

void write_miss(Story& story) {
    story.push_back("leaves the scene");
}

void write_emission(Story& story, const glm::vec3& emission, const glm::vec3& direction) {
    story.push_back("  sees emission " + text(emission) + " along " + text(direction));
}

void write_light(Story& story, const glm::vec3& direction, const glm::vec3& gathered) {
    story.push_back("  light " + text(direction) + " adds " + text(gathered));
}

void write_specular(Story& story, bool reflects, const glm::vec3& direction) {
    story.push_back((reflects ? "  reflected to " : "  refracted to ") + text(direction));
}

void write_end(Story& story, const glm::vec3& radiance, std::uint64_t rays) {
    story.push_back("radiance (" + std::to_string(radiance.x) + ", " + std::to_string(radiance.y) + ", " +
                    std::to_string(radiance.z) + ") from " + std::to_string(rays) + " rays");
}

}  // namespace tessera::backend
