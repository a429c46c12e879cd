#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/shading/world.h"

namespace tessera::shading {

// A world and all that it points to, as bytes that will lie at `address`.
struct PackedWorld {
    std::vector<std::byte> bytes;
    World world;
};

// Scenes of 8 instances with every kind of array, texture, material and light; views of every kind. Instances
// 4 to 7 are hard: needles, triangles without area, tiny and huge, near mirrors, glass. Only addresses differ
// between calls.
PackedWorld make_world(std::uint64_t address);

}  // namespace tessera::shading
