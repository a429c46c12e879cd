#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "backends/embree/lights.h"
#include "mediator/scene/objects.h"

namespace tessera::embree {

// Lights of the scene graph, placed relative to the render origin, and how far the scene reaches.
struct PlacedLights {
    struct Item {
        const scene::Light* source;
        glm::vec3 position, direction;
    };
    std::vector<Item> items;
    double scene_radius = 1.0;
};

// Instances that emit get their light's index.
LightTable make_lights(SceneTables& tables, const PlacedLights& placed);

}  // namespace tessera::embree
