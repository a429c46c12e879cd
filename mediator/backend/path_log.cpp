#include "mediator/backend/path_log.h"

#include <cstdio>

namespace tessera::backend {

namespace {

std::string text(const glm::vec3& v) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, "(%.9g, %.9g, %.9g)", double(v.x), double(v.y), double(v.z));
    return buffer;
}

}  // namespace

void write_camera(PathLog& path_log, const shading::Ray& ray) {
    path_log.push_back("camera " + text(ray.origin) + " direction " + text(ray.direction));
}

void write_hit(PathLog& path_log, const shading::Surface& surface, const glm::vec3& throughput) {
    path_log.push_back("hit object " + std::to_string(surface.object) + " triangle " +
                       std::to_string(surface.triangle) + " at " + text(surface.position) + " normal " +
                       text(surface.frame[2]) + ", throughput " + text(throughput));
}

void write_miss(PathLog& path_log) {
    path_log.push_back("leaves the scene");
}

void write_emission(PathLog& path_log, const glm::vec3& emission, const glm::vec3& direction) {
    path_log.push_back("  emission " + text(emission) + " along " + text(direction));
}

void write_light(PathLog& path_log, const glm::vec3& direction, const glm::vec3& gathered) {
    path_log.push_back("  light " + text(direction) + " adds " + text(gathered));
}

void write_specular(PathLog& path_log, bool reflects, const glm::vec3& direction) {
    path_log.push_back((reflects ? "  reflected to " : "  refracted to ") + text(direction));
}

void write_end(PathLog& path_log, const glm::vec3& radiance, std::uint64_t rays) {
    path_log.push_back("radiance (" + std::to_string(radiance.x) + ", " + std::to_string(radiance.y) + ", " +
                       std::to_string(radiance.z) + ") from " + std::to_string(rays) + " rays");
}

}  // namespace tessera::backend
