#pragma once

#include <vector>

#include "backends/embree/kernel.h"
#include "tests/statistics/model.h"

namespace tessera::embree {

// A common scene plus one rarely used feature on one of its objects.
struct RareFeatureScene {
    const char* name;
    void (*add)(Model& model);
    const Kernel* exact;  // has exactly the scene's features
};

// The first has no rare feature.
const std::vector<RareFeatureScene>& rare_feature_scenes();

inline view::View rare_feature_view(std::uint32_t size) {
    view::View view = small_view({0.0, 0.8, 4.5}, 0.9, size);
    view.channels = {frame::Channel::Radiance};
    return view;
}

}  // namespace tessera::embree
