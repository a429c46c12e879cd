#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/shading/test_scene.h"

namespace tessera::shading {

// A test scene and all arrays that it points to, as bytes to be placed at `address`.
struct PackedTestScene {
    std::vector<std::byte> bytes;
    TestScene test_scene;
};

// Scenes of 8 instances with every kind of array, texture, material and light; views of every kind. Instances
// 4 to 7 are edge cases: thin triangles, triangles without area, tiny and huge, near mirrors, glass. Only
// addresses differ between calls.
PackedTestScene make_test_scene(std::uint64_t address);

}  // namespace tessera::shading
