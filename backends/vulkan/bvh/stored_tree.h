#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "backends/vulkan/bvh/mesh_bvh.h"

namespace tessera::vulkan {

// A mesh's tree as bytes: its shape in the order of visits and its row of primitives, so that they cannot
// name a wrong place, and its cost. Boxes are not among them: they follow from the mesh.
std::vector<std::byte> stored(const WideTree& tree);

// The same tree, bit for bit. Nothing for bytes that are no tree of this mesh, whoever wrote them: given is
// only what is at most BvhMeshDepth deep, holds every triangle that can be hit once, and costs what is said
// to a bit.
std::optional<WideTree> restored(std::span<const std::byte> bytes, const MeshData& mesh,
                                 const TraversalCosts& costs = {});

}  // namespace tessera::vulkan
