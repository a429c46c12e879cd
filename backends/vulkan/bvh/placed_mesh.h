#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

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
    std::span<const shading::Place> places{};  // where it moves: at the beginning and at each step after it
    std::uint32_t mesh_steps = 0;              // of the mesh's motion, after the beginning
};

// Around the mesh as rays see it. Empty for an instance that is left out and never hit: its mesh is empty,
// its transform has no inverse (if it moves: at no step), or it reaches beyond +-1.8e18. All that it goes
// through.
Box world_box(const PlacedMesh& placed);

// `number`: what hits will name. `places`: where its matrices are, in items from the top level's root.
shading::BvhInstance record_of(const PlacedMesh& placed, std::uint32_t number, std::uint32_t places);

// The items of a place: rows of world from object.
std::array<glm::vec4, shading::BvhPlaceItems> rows_of(const shading::Place& place);

}  // namespace tessera::vulkan
