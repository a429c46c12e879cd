#pragma once

#include <memory>
#include <vector>

#include "tests/bench/backends/bench_targets.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::tools::bench {

// Rays as traced by paths, for traversal without shading.
struct RaySets {
    std::vector<shading::RayQuery> primary;  // camera rays, in tiles of 8 x 8 pixels
    // From the hits of the primary rays: shadow rays to other visible points, and diffuse bounces.
    std::vector<shading::RayQuery> shadow, bounce;
};

// About `count` primary rays. The caster, which has the scene, finds their hits.
RaySets ray_sets(const BenchScene& scene, std::shared_ptr<scene::BlobStore> blobs, std::uint32_t count,
                 tessera::bench::RayCaster& caster);

}  // namespace tessera::tools::bench
