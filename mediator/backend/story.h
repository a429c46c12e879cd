#pragma once

#include <string>
#include <vector>

#include "mediator/shading/surfaces.h"

// What a probe tells of a path: a line for what happens at each vertex. The shared transport calls these for
// any context that has `story`, which may be null.
namespace tessera::backend {

using Story = std::vector<std::string>;

void write_camera(Story& story, const shading::Ray& ray);
void write_hit(Story& story, const shading::Surface& surface, const glm::vec3& throughput);
void write_miss(Story& story);
void write_emission(Story& story, const glm::vec3& emission, const glm::vec3& direction);
void write_light(Story& story, const glm::vec3& direction, const glm::vec3& gathered);
void write_specular(Story& story, bool reflects, const glm::vec3& direction);
void write_end(Story& story, const glm::vec3& radiance, std::uint64_t rays);

// A context of the transport that tells.
struct Teller {
    Story* story = nullptr;
};
inline void tell_camera(const Teller& context, const shading::Ray& ray) {
    if (context.story != nullptr) write_camera(*context.story, ray);
}
inline void tell_hit(const Teller& context, const shading::Surface& surface, const glm::vec3& throughput) {
    if (context.story != nullptr) write_hit(*context.story, surface, throughput);
}
inline void tell_miss(const Teller& context) {
    if (context.story != nullptr) write_miss(*context.story);
}
inline void tell_emission(const Teller& context, const glm::vec3& emission, const glm::vec3& direction) {
    if (context.story != nullptr) write_emission(*context.story, emission, direction);
}
inline void tell_light(const Teller& context, const glm::vec3& direction, const glm::vec3& gathered) {
    if (context.story != nullptr) write_light(*context.story, direction, gathered);
}
inline void tell_specular(const Teller& context, bool reflects, const glm::vec3& direction) {
    if (context.story != nullptr) write_specular(*context.story, reflects, direction);
}

// On the host all is there.
inline bool has_specular_trees(const Teller&) {
    return true;
}

}  // namespace tessera::backend
