#pragma once

#include <string_view>
#include <vector>

#include "client/tools/bench/scenes.h"

namespace tessera::tools::bench {

// Made in code, of a few triangles each, so that every build can measure on them.
//   cornell          closed diffuse box, 2 m, two blocks, area light in the ceiling
//   cornell-spheres  the same box with a mirror sphere and a glass sphere
//   caustics         a glass sphere on a plane under a small light: what of it a path finds by chance
//   grids            two layers of bars over a plane under a square light, direct light only (GRIDS, Mehta
//                    ch. 3). Sizes of the check in our notes: light of 2 sigma = 0.5 m at 4 m, layers at
//                    0.4 m and 1.5 m over a plane of 6 m; penumbrae from sigma s = 0.03 m to 0.15 m
struct BuiltIn {
    std::string_view name;
    BenchScene (*make)();
};
const std::vector<BuiltIn>& built_in_scenes();

}  // namespace tessera::tools::bench
