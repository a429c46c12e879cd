#pragma once

#include <string_view>
#include <vector>

#include "tests/bench/scenes/scenes.h"

namespace tessera::tools::bench {

// Procedural scenes of a few triangles each, available in every build.
//   cornell          closed diffuse box, 2 m, two blocks, area light in the ceiling
//   cornell-spheres  the same box with a mirror sphere and a glass sphere
//   caustics         a glass sphere on a plane under a small light: light that paths only find by chance
//   grids            two layers of bars over a plane under a square light, direct light only (GRIDS, Mehta
//                    ch. 3, whose sizes are not printed): light of 2 sigma = 1 m at d1 = 4 m over a plane of
//                    6 m, layers at 0.4 m and 1.5 m; penumbrae sigma (d1 / d2 - 1) of 0.06 m and 0.3 m
//   furnace          spheres of plastic and metal under an even sky
//   glossy           metal plates of growing roughness and lamps of growing size (Veach)
struct BuiltIn {
    std::string_view name;
    BenchScene (*make)();
    bool is_default = true;  // in the default list; `bench transport` has all
};
const std::vector<BuiltIn>& built_in_scenes();

// "balls:N": 50 balls in a box under a light, of about N triangles (at least 1,000) in one mesh. For ray
// benchmarks; not in the default list.
BenchScene balls(std::uint32_t triangles);

}  // namespace tessera::tools::bench
