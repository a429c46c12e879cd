#pragma once

#include <embree3/rtcore.h>

#include <glm/vec3.hpp>
#include <optional>

#include "backends/embree/scene_tables.h"

namespace tessera::embree {

struct Ray {
    glm::vec3 origin, direction;  // unit length
};

struct Hit {
    RTCHit hit;
    float distance;
};

// Embree behind two questions. `seed` decides at surfaces with alpha (alpha_filter).
class RayCaster {
  public:
    RayCaster(const SceneTables& tables, RTCScene scene) : tables_(tables), scene_(scene) {}

    const SceneTables& tables() const { return tables_; }
    std::optional<Hit> closest(const Ray& ray, std::uint32_t seed) const;
    // Anything between the origin and the share `far` of the segment?
    bool occluded(const glm::vec3& origin, const glm::vec3& segment, float far, std::uint32_t seed) const;

  private:
    const SceneTables& tables_;
    RTCScene scene_;
};

}  // namespace tessera::embree
