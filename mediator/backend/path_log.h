#pragma once

#include <string>
#include <vector>

#include "mediator/backend/sky_cells.h"
#include "mediator/shading/light_tree.h"
#include "mediator/shading/surfaces.h"

// The log of a probed path: one line per event at each vertex. The shared transport code calls log_*() with its
// context, whose `path_log` may be null.
namespace tessera::backend {

using PathLog = std::vector<std::string>;

void write_camera(PathLog& path_log, const shading::Ray& ray);
void write_hit(PathLog& path_log, const shading::Surface& surface, const glm::vec3& throughput);
void write_miss(PathLog& path_log);
void write_emission(PathLog& path_log, const glm::vec3& emission, const glm::vec3& direction);
void write_light(PathLog& path_log, const glm::vec3& direction, const glm::vec3& gathered);
void write_specular(PathLog& path_log, bool reflects, const glm::vec3& direction);
void write_end(PathLog& path_log, const glm::vec3& radiance, std::uint64_t rays);

// The part of a transport context that logs.
struct PathLogger {
    PathLog* path_log = nullptr;
    std::vector<SkyPlace>* sky_places = nullptr;  // where light is sampled
};
inline void log_receiver(const PathLogger& context, const shading::Receiver& receiver,
                         const shading::Ray& ray) {
    if (context.sky_places != nullptr)
        context.sky_places->push_back({receiver.position, receiver.normal, ray.origin});
}
inline void log_camera(const PathLogger& context, const shading::Ray& ray) {
    if (context.path_log != nullptr) write_camera(*context.path_log, ray);
}
inline void log_hit(const PathLogger& context, const shading::Surface& surface, const glm::vec3& throughput) {
    if (context.path_log != nullptr) write_hit(*context.path_log, surface, throughput);
}
inline void log_miss(const PathLogger& context) {
    if (context.path_log != nullptr) write_miss(*context.path_log);
}
inline void log_emission(const PathLogger& context, const glm::vec3& emission, const glm::vec3& direction) {
    if (context.path_log != nullptr) write_emission(*context.path_log, emission, direction);
}
inline void log_light(const PathLogger& context, const glm::vec3& direction, const glm::vec3& gathered) {
    if (context.path_log != nullptr) write_light(*context.path_log, direction, gathered);
}
inline void log_specular(const PathLogger& context, bool reflects, const glm::vec3& direction) {
    if (context.path_log != nullptr) write_specular(*context.path_log, reflects, direction);
}

// The host code has all features.
inline bool has_specular_trees(const PathLogger&) {
    return true;
}

}  // namespace tessera::backend
