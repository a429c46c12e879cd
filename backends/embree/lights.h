#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace tessera::embree {

struct SceneTables;

enum class LightType { Point, Spot, Directional, Mesh, Environment };

struct LightData {
    LightType type = LightType::Point;
    glm::vec3 position{0.0f}, direction{0.0f};  // it shines along `direction`
    glm::vec3 intensity{0.0f};
    float cos_inner = 1.0f, cos_outer = 0.0f;
    std::uint32_t instance = 0;          // of a mesh light
    std::vector<float> cumulative_area;  // of its triangles in the world, normalised
    float area = 0.0f;                   // in total
    double power = 0.0;                  // estimate, for choosing
    float probability = 0.0f;
};

// One light out of all, in proportion to its power, a tenth uniformly (so that a wrong estimate costs noise,
// never light). Order: mesh lights by instance, then point-like lights by (id, path), then the environment.
struct LightTable {
    std::vector<LightData> lights;
    std::vector<float> cumulative;
    std::int32_t environment = -1;  // index
};

// Index of the light that u chooses; -1 without lights.
std::int32_t choose_light(const LightTable& table, float u);

}  // namespace tessera::embree
