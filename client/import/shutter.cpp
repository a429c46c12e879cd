#include "client/import/shutter.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "mediator/view/placed_cameras.h"

namespace tessera::import {
namespace {

// Whether straight lines between every (Looks / steps)-th look stay near the others: `leaves(i, a, b, share)`
// tells if look i is too far from that share of the way from look a to look b.
template <class Leaves>
std::size_t count_steps(const Leaves& leaves) {
    for (const std::size_t steps : {1, 3, 5}) {
        const std::size_t stride = Looks / steps;
        bool fits = true;
        for (std::size_t i = 0; i <= Looks && fits; ++i) {
            const std::size_t a = std::min(i / stride, steps - 1) * stride;
            fits = !leaves(i, a, a + stride, double(i - a) / double(stride));
        }
        if (fits) return steps;
    }
    return Looks;
}

template <class T>
std::vector<T> chosen(std::span<const T> looks, std::size_t steps) {
    std::vector<T> made;
    for (std::size_t i = 1; i <= steps; ++i) made.push_back(looks[i * (Looks / steps)]);
    return made;
}

double tolerance() {
    return 1.0 - std::cos(glm::radians(3.0));
}

}  // namespace

std::vector<glm::dmat4> steps_of(std::span<const glm::dmat4> looks) {
    double size = 0.0, way = 0.0;
    bool moves = false;
    for (const glm::dmat4& look : looks) {
        moves = moves || look != looks[0];
        for (int column = 0; column < 3; ++column) {
            for (int row = 0; row < 3; ++row) size = std::max(size, std::abs(look[column][row]));
        }
        way = std::max(way, glm::distance(look[3], looks[0][3]));
    }
    if (!moves) return {};
    const auto leaves = [&](std::size_t i, std::size_t a, std::size_t b, double share) {
        const glm::dmat4 off = looks[a] + (looks[b] - looks[a]) * share - looks[i];
        double linear = 0.0;
        for (int column = 0; column < 3; ++column) linear = std::max(linear, glm::length(off[column]));
        // Rounding of the looks is no way.
        return linear > tolerance() * size ||
               glm::length(off[3]) > tolerance() * way + 1e-12 * glm::length(looks[i][3]);
    };
    return chosen(looks, count_steps(leaves));
}

std::vector<std::vector<glm::vec3>> steps_of(const std::vector<std::vector<glm::vec3>>& looks) {
    float way = 0.0f;
    for (const auto& look : looks) {
        for (std::size_t v = 0; v < look.size(); ++v)
            way = std::max(way, glm::distance(look[v], looks[0][v]));
    }
    if (!(way > 0.0f)) return {};
    const auto leaves = [&](std::size_t i, std::size_t a, std::size_t b, double share) {
        for (std::size_t v = 0; v < looks[i].size(); ++v) {
            const glm::vec3 straight = looks[a][v] + (looks[b][v] - looks[a][v]) * float(share);
            if (glm::distance(straight, looks[i][v]) > float(tolerance()) * way) return true;
        }
        return false;
    };
    return chosen(std::span(looks), count_steps(leaves));
}

void move_cameras(ImportedScene& imported) {
    scene::Scene scene;
    if (!scene.apply_entries(entries(imported, RootEntry::Create))) return;
    for (const view::PlacedCamera& placed : view::placed_cameras(scene)) {
        for (CameraInfo& camera : imported.cameras) {
            if (camera.name == placed.name) camera.motion = placed.motion;
        }
    }
}

}  // namespace tessera::import
