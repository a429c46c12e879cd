#pragma once

#include "backends/embree/surface.h"

namespace tessera::embree {

// A place where light comes from, seen from a surface.
struct LightSample {
    glm::vec3 radiance{
        0.0f};  // that arrives when nothing is in between; for a delta light divided by its distance squared
    glm::vec3 intensity{0.0f};  // the light's own, towards the surface, whatever the distance
    glm::vec3 direction{0.0f};  // to the light, unit length
    float pdf = 0.0f;           // per solid angle, choice of the light included; 0 = no light
    bool delta = false;         // cannot be hit by chance: the pdf is of the choice alone
    // The shadow ray: from origin along `segment` until far (a share of the segment, or infinity).
    glm::vec3 origin{0.0f}, segment{0.0f};
    float far = 1.0f;
};

LightSample sample_light(const SceneTables& tables, const Surface& surface, float choice, const glm::vec2& u);

// Density with which sample_light finds the hit point of a mesh light, or a direction of the environment.
float mesh_light_pdf(const SceneTables& tables, const Surface& light_surface, const glm::vec3& from);
float environment_pdf(const SceneTables& tables, const glm::vec3& direction);

}  // namespace tessera::embree
