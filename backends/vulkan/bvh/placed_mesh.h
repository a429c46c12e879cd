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
    std::uint32_t nodes = 0, triangles = 0;  // offsets in the pool, in items
    bool alpha_tested = false;
    std::uint32_t layers = shading::AllLayers;
    std::span<const shading::Affine3x4> transform_keys{};  // if it moves: one per motion key
    std::uint32_t mesh_key_intervals = 0;                  // of a deforming mesh
};

// Conservative world bounds over the whole motion. Empty for an instance that is left out and never hit: its
// mesh is empty, its transform is singular (if it moves: at any key), or it extends beyond +-1.8e18.
Box world_box(const PlacedMesh& placed);

// `number`: the instance index reported by hits. `places`: offset of its matrices, in items from the top level's
// root.
shading::BvhInstance record_of(const PlacedMesh& placed, std::uint32_t number, std::uint32_t places);

// The items of a transform: rows of world from object.
std::array<glm::vec4, shading::BvhTransformItems> rows_of(const shading::Affine3x4& place);

}  // namespace tessera::vulkan
