#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "backends/embree/texture.h"

namespace tessera::embree {

// Light from infinitely far: a colour plus a latitude-longitude map. Sampled in proportion to the map's
// brightness (per texel, with its neighbours, so that whatever bilinear filtering shows can be sampled), or
// uniformly without a map.
class Environment {
  public:
    Environment() = default;
    Environment(const scene::Background& background, const TextureData* map);

    bool emits() const { return mean_luminance_ > 0.0; }
    double mean_luminance() const { return mean_luminance_; }  // over the sphere
    glm::vec3 radiance(const glm::vec3& direction) const;

    struct Sample {
        glm::vec3 direction{0.0f};
        float pdf = 0.0f;  // per solid angle
    };
    Sample sample(const glm::vec2& u) const;
    float pdf(const glm::vec3& direction) const;

  private:
    glm::vec2 to_map(const glm::vec3& direction) const;

    glm::vec3 color_{0.0f};
    float strength_ = 1.0f, rotation_ = 0.0f;
    TextureData map_;
    bool has_map_ = false;
    double mean_luminance_ = 0.0;
    // Cumulative sums, normalised to end at 1: of rows, and of the texels of each row.
    std::vector<float> rows_, columns_;
};

}  // namespace tessera::embree
