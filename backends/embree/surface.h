#pragma once

#include <embree3/rtcore.h>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "backends/embree/scene_tables.h"
#include "mediator/shading/specular.h"

namespace tessera::embree {

// What a path needs to know of the point it has reached.
struct Surface {
    glm::vec3 position{0.0f};
    glm::vec3 error{0.0f};             // bound of the position's rounding error, per axis
    glm::vec3 geometric_normal{0.0f};  // of unit length, to the side the path came from
    glm::mat3 frame{1.0f};             // shading frame, third axis = shading normal, same side
    glm::vec3 albedo{0.0f}, emission{0.0f};
    shading::Bsdf bsdf{};          // of what is no perfect specular
    shading::Specular specular{};  // perfect mirror and smooth glass; directions in the world
    float rough_share = 1.0f;      // of the material that is no perfect specular
    const InstanceData* instance = nullptr;
    std::uint32_t triangle = 0;
    bool scatters = true;

    glm::vec3 to_local(const glm::vec3& world) const { return world * frame; }
    glm::vec3 to_world(const glm::vec3& local) const { return frame * local; }
};

// `direction`: of the ray that hit, unit length.
Surface make_surface(const SceneTables& tables, const RTCHit& hit, const glm::vec3& direction);

// A point of an instance's triangle and the bound of the distance, per axis, at which Embree may find the
// triangle around it. In the object's frame: interpolation, 5 roundings of the corners' coordinates; Embree's
// distance to the plane, 8 roundings (differences, cross product, dot product) of the triangle's extent. Then
// 6 roundings of the way to the world and as many of Embree's way back. gamma_n = n u / (1 - n u), u = 2^-24
// (Higham 2002).
struct PointWithError {
    glm::vec3 position, error;
};
PointWithError point_on(const InstanceData& instance, std::uint32_t triangle, const glm::vec2& barycentric);

// Moves the point along the normal out of its error box, to the side `direction` leads to.
glm::vec3 leave_surface(const PointWithError& point, const glm::vec3& normal, const glm::vec3& direction);

}  // namespace tessera::embree
