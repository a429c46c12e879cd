#include "tests/bench/scenes/shapes.h"

#include <array>
#include <cmath>
#include <numbers>

namespace tessera::tools::bench {

Mesh quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    return {{a, b, c, d}, {}, {0, 1, 2, 0, 2, 3}};
}

void append(Mesh& mesh, const Mesh& more) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
    mesh.normals.insert(mesh.normals.end(), more.normals.begin(), more.normals.end());
    for (const std::uint32_t index : more.indices) mesh.indices.push_back(first + index);
}

Mesh block(glm::vec3 base_centre, glm::vec3 size, float angle) {
    const float cosine = std::cos(angle), sine = std::sin(angle);
    std::array<glm::vec3, 8> p;
    for (unsigned i = 0; i < 8; ++i) {
        const float x = ((i & 1u) ? 0.5f : -0.5f) * size.x, z = ((i & 4u) ? 0.5f : -0.5f) * size.z;
        p[i] =
            base_centre + glm::vec3(cosine * x + sine * z, (i & 2u) ? size.y : 0.0f, cosine * z - sine * x);
    }
    Mesh mesh;
    constexpr std::array<std::array<unsigned, 4>, 6> Faces{
        {{4, 5, 7, 6}, {1, 0, 2, 3}, {5, 1, 3, 7}, {0, 4, 6, 2}, {6, 7, 3, 2}, {0, 1, 5, 4}}};
    for (const auto& f : Faces) append(mesh, quad(p[f[0]], p[f[1]], p[f[2]], p[f[3]]));
    return mesh;
}

Mesh sphere(glm::vec3 centre, float radius, std::uint32_t rings) {
    Mesh mesh;
    const std::uint32_t around = 2 * rings;
    for (std::uint32_t i = 0; i <= rings; ++i) {
        const float theta = std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(rings);
        for (std::uint32_t j = 0; j <= around; ++j) {
            const float phi =
                2.0f * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(around);
            const glm::vec3 normal(std::sin(theta) * std::sin(phi), std::cos(theta),
                                   std::sin(theta) * std::cos(phi));
            mesh.normals.push_back(normal);
            mesh.positions.push_back(centre + radius * normal);
        }
    }
    for (std::uint32_t i = 0; i < rings; ++i) {
        for (std::uint32_t j = 0; j < around; ++j) {
            const std::uint32_t a = i * (around + 1) + j, b = a + around + 1;
            if (i + 1 < rings) mesh.indices.insert(mesh.indices.end(), {a, b, b + 1});
            if (i > 0) mesh.indices.insert(mesh.indices.end(), {a, b + 1, a + 1});
        }
    }
    return mesh;
}

Mesh grid(float height, float edge, std::uint32_t bars, float width) {
    Mesh mesh;
    const float half = 0.5f * edge;
    for (std::uint32_t i = 0; i < bars; ++i) {
        const float at = -half + edge * (static_cast<float>(i) + 0.5f) / static_cast<float>(bars);
        const float low = at - 0.5f * width, high = at + 0.5f * width;
        append(mesh,
               quad({low, height, half}, {high, height, half}, {high, height, -half}, {low, height, -half}));
        append(mesh,
               quad({-half, height, high}, {half, height, high}, {half, height, low}, {-half, height, low}));
    }
    return mesh;
}

}  // namespace tessera::tools::bench
