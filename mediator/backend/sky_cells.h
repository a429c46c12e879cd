#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <stop_token>
#include <vector>

#include "mediator/backend/tables/tables.h"

// Makes the cells of mediator/shading/sky_cells.h: where the surfaces that a view's paths meet see the sky.
namespace tessera::backend {

// A point of a rough surface.
struct SkyPlace {
    glm::vec3 position, normal;  // as of a receiver (mediator/shading/light_tree.h)
    glm::vec3 origin;            // of its shadow rays
};

// How a back-end traces the view. Called by several threads.
struct SkyRays {
    // Adds the rough vertices of one path.
    std::function<void(std::uint32_t x, std::uint32_t y, std::uint64_t sample, std::vector<SkyPlace>& places)>
        trace_path;
    // Whether light from the direction arrives; `number`: of the ray, for random numbers.
    std::function<bool(const SkyPlace& place, const glm::vec3& direction, std::uint32_t number)> sees_sky;
};

struct SkyCells {
    std::vector<shading::SkyNode> nodes;  // none: the view does not need them
    std::vector<shading::SkyCell> cells;
    std::vector<float> cdfs;
    double visible = 1.0;       // share of the sky's light that arrives at the places, in [0, 1]
    double visible_suns = 1.0;  // the same of directional lights

    bool empty() const { return cells.empty(); }
    // The addresses must stay valid.
    void use_in(shading::View& view, std::uint32_t first_sample) const;
};

// A pure function of scene, view and rays. Empty where sky and suns are black or most of them is seen: light samples in
// proportion to their unoccluded light do as well there. nullopt: stopped. `threads`: 0 = all cores.
std::optional<SkyCells> make_sky_cells(const SceneTables& tables, const shading::View& view,
                                       const SkyRays& rays, std::uint32_t threads,
                                       const std::stop_token& stop);

}  // namespace tessera::backend
