#pragma once

#include <vector>

#include "backends/embree/kernel.h"
#include "tests/statistics/model.h"

namespace tessera::embree {

// An ordinary scene with one feature that is seldom, on one of its objects.
struct SeldomScene {
    const char* name;
    void (*add)(Model& model);
    const Kernel* exact;  // has the scene's features and no other
};

// The first has none.
const std::vector<SeldomScene>& seldom_scenes();

inline view::View seldom_view(std::uint32_t size) {
    view::View view = small_view({0.0, 0.8, 4.5}, 0.9, size);
    view.channels = {frame::Channel::Radiance};
    return view;
}

}  // namespace tessera::embree
