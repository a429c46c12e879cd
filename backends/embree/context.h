#pragma once

#include <embree3/rtcore.h>

#include <string>
#include <vector>

#include "mediator/shading/surfaces.h"

// What the shared transport asks of this back-end (mediator/shading/transport.h).
namespace tessera::embree {

struct Context {
    const shading::Scene& scene;
    const shading::View& view;
    RTCScene top;
    std::vector<std::string>* story = nullptr;  // if there, gets a line for what happens
};

bool trace_closest(const Context& context, const shading::Ray& ray, std::uint32_t seed, shading::Hit& hit);
bool trace_occluded(const Context& context, const glm::vec3& origin, const glm::vec3& segment, float far,
                    std::uint32_t seed);

void write_camera(std::vector<std::string>& story, const shading::Ray& ray);
void write_hit(std::vector<std::string>& story, const shading::Surface& surface, const glm::vec3& throughput);
void write_miss(std::vector<std::string>& story);
void write_emission(std::vector<std::string>& story, const glm::vec3& emission, const glm::vec3& direction);
void write_light(std::vector<std::string>& story, const glm::vec3& direction, const glm::vec3& gathered);
void write_specular(std::vector<std::string>& story, bool reflects, const glm::vec3& direction);

inline void tell_camera(const Context& context, const shading::Ray& ray) {
    if (context.story != nullptr) write_camera(*context.story, ray);
}
inline void tell_hit(const Context& context, const shading::Surface& surface, const glm::vec3& throughput) {
    if (context.story != nullptr) write_hit(*context.story, surface, throughput);
}
inline void tell_miss(const Context& context) {
    if (context.story != nullptr) write_miss(*context.story);
}
inline void tell_emission(const Context& context, const glm::vec3& emission, const glm::vec3& direction) {
    if (context.story != nullptr) write_emission(*context.story, emission, direction);
}
inline void tell_light(const Context& context, const glm::vec3& direction, const glm::vec3& gathered) {
    if (context.story != nullptr) write_light(*context.story, direction, gathered);
}
inline void tell_specular(const Context& context, bool reflects, const glm::vec3& direction) {
    if (context.story != nullptr) write_specular(*context.story, reflects, direction);
}

}  // namespace tessera::embree
