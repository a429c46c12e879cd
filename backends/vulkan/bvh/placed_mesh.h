#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "backends/vulkan/bvh/box.h"
#include "mediator/shading/bvh_layout.h"
#include "mediator/shading/records.h"

namespace tessera::vulkan {

// One mesh placed in the world.
struct PlacedMesh {
    glm::mat3 linear{1.0f};  // world from object
    glm::vec3 translation{0.0f};
    Box box;                                 // of the mesh, in its own space (WideTree::box)
    std::uint32_t nodes = 0, triangles = 0;  // where the mesh's rows begin in the pool, in items
    bool alpha_tested = false;
    std::uint32_t layers = shading::AllLayers;
};

// Around the mesh as rays see it. Empty for an instance that is left out and never hit: its mesh is empty,
// its transform has no inverse, or it reaches beyond +-1.8e18.
Box world_box(const PlacedMesh& placed);

// `number`: what hits will name.
shading::BvhInstance record_of(const PlacedMesh& placed, std::uint32_t number);

}  // namespace tessera::vulkan
