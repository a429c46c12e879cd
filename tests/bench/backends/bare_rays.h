#pragma once

#include <memory>
#include <vector>

#include "tests/bench/backends/contenders.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::tools::bench {

// Rays as paths cast them, for traversal without shading.
struct RaySets {
    std::vector<shading::AskedRay> primary;  // of the camera, 8 x 8 pixels after each other
    // From what those hit: to points before other places that the camera sees, and diffuse bounces.
    std::vector<shading::AskedRay> shadow, bounce;
};

// About `count` primary rays. Hits are asked of the caster, which has the scene.
RaySets ray_sets(const BenchScene& scene, std::shared_ptr<scene::BlobStore> blobs, std::uint32_t count,
                 tessera::bench::RayCaster& caster);

}  // namespace tessera::tools::bench
