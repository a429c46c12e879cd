#pragma once

#include <functional>

#include "mediator/base/random.h"
#include "tests/statistics/model.h"

// Emissive triangles over a diffuse ground, seen at its origin, against Lambert's closed form.
namespace tessera::embree {

constexpr float GroundAlbedo = 0.6f;

struct Panel {
    std::array<glm::vec3, 3> corners;  // counter-clockwise as seen from the front
    double radiance = 1.0;
};

// Irradiance of the origin, normal +z, by a triangle above the ground that faces it (Lambert 1760).
inline double irradiance_of(const Panel& panel) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 a = panel.corners[i], b = panel.corners[(i + 1) % 3];
        const glm::dvec3 across = glm::cross(a, b);
        const double angle = std::atan2(glm::length(across), glm::dot(a, b));
        sum += angle * across.z / glm::length(across);
    }
    return 0.5 * panel.radiance * std::fabs(sum);
}

inline bool faces_origin(const Panel& panel) {
    const auto& c = panel.corners;
    return glm::dot(glm::cross(glm::dvec3(c[1] - c[0]), glm::dvec3(c[2] - c[0])), glm::dvec3(c[0])) < 0.0;
}

// What is seen of the ground at the origin.
inline double reflected(const std::vector<Panel>& panels) {
    double sum = 0.0;
    for (const Panel& panel : panels) sum += faces_origin(panel) ? irradiance_of(panel) : 0.0;
    return GroundAlbedo / M_PI * sum;
}

// In all directions, none before another: one in each of `count`^2 cells of the hemisphere. Every fifth shows
// the origin its back.
inline std::vector<Panel> dome(int count, double farthest, std::uint64_t seed) {
    CounterRandom random(seed);
    std::vector<Panel> panels;
    for (int i = 0; i < count * count; ++i) {
        const double cosine = (0.5 + i / count) / count, phi = 2.0 * M_PI * (0.5 + i % count) / count;
        const double sine = std::sqrt(1.0 - cosine * cosine), size = 0.3 / count;
        const glm::dvec3 direction(sine * std::cos(phi), sine * std::sin(phi), cosine);
        const glm::dvec3 across = glm::normalize(glm::cross(direction, {0.0, 0.0, 1.0}));
        const glm::dvec3 up = glm::cross(across, direction);
        const double distance = std::pow(farthest, random.uniform());
        Panel panel{.radiance = std::pow(100.0, random.uniform())};
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const double angle = 2.0 * M_PI * double(corner) / 3.0 + random.uniform();
            const glm::dvec3 offset = size * (std::cos(angle) * across + std::sin(angle) * up);
            panel.corners[corner] =
                glm::vec3(distance * (direction + offset + 0.3 * size * random.uniform()));
        }
        if (faces_origin(panel) == (i % 5 == 0)) std::swap(panel.corners[0], panel.corners[1]);
        panels.push_back(panel);
    }
    return panels;
}

// Of a function of points that are uniform in the unit square.
inline Mean mean_over_square(const std::function<double(const glm::vec2&)>& value) {
    constexpr int Count = 200'000;
    CounterRandom random(32);
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < Count; ++i) {
        const double found =
            value({float(random.uniform()) * 0.99999994f, float(random.uniform()) * 0.99999994f});
        sum += found;
        squares += found * found;
    }
    const double mean = sum / Count;
    return {mean, std::sqrt(std::max(0.0, squares / Count - mean * mean) / Count)};
}

enum class Sides { One, Both };

inline void add_panels(Model& model, const std::vector<Panel>& panels, Sides sides,
                       std::uint32_t layers = scene::RootLayers) {
    for (const Panel& panel : panels) {
        scene::Material emissive = lamp(static_cast<float>(panel.radiance));
        emissive.double_sided = sides == Sides::Both;
        model.triangles(model.material(emissive), {panel.corners}, layers);
    }
}

inline void add_ground(Model& model, float size = 1.0f) {
    model.floor(model.material(chalk(glm::vec3(GroundAlbedo))), size, 0.0f);
}

// The ground's origin, from `height` above, without light that is scattered twice.
inline view::View at_origin(double height) {
    view::View view = small_view({0.0, 0.0, height}, 1e-3);
    view.max_bounces = 0;
    return view;
}

inline Mean seen_by(const SceneAdapter& world, const view::View& view, Strategy strategy, std::uint64_t spp) {
    const PathTracer tracer(world.tables(), world.scene(), view, strategy);
    double sum = 0, squares = 0;
    std::uint64_t rays = 0;
    const double count = 256.0 * static_cast<double>(spp);
    for (std::uint64_t i = 0; i < 256 * spp; ++i) {
        const double value = red(tracer.trace(i % 16, i / 16 % 16, i / 256, rays));
        sum += value;
        squares += value * value;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
}

// A right estimate is farther off in one of 16,000.
inline void expect_light(const Mean& found, double expected, double most_error = 0.003) {
    EXPECT_LE(found.standard_error, most_error * expected);
    EXPECT_NEAR(found.value, expected, 4.0 * found.standard_error + 2e-5 * expected);
}

}  // namespace tessera::embree
