#pragma once

#include "tests/statistics/model.h"

// Views and estimators for tests of participating media.
namespace tessera::embree {

inline constexpr ObjectId NoMaterial{};

inline double channel(const PathSample& sample, int index) {
    return double(radiance_of(sample)[index]);
}

inline Mean mean_of_channel(const SceneAdapter& world, const view::View& view, std::uint64_t spp, int c) {
    return mean_of(world, view, spp, [&](const PathSample& s) { return channel(s, c); });
}

// Looks straight down at the origin.
inline view::View view_from_above(double height = 10.0) {
    return small_view({0, 0, height}, 1e-4);
}

inline view::View whitted(view::View view) {
    view.renderer = view::Renderer::Whitted;
    return view;
}

}  // namespace tessera::embree
