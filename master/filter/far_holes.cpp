#include "master/filter/far_holes.h"

#include <algorithm>

namespace tessera::filter {

bool FarHoles::fill(const Planes& reached, Planes& picture, RunContext& context) {
    if (std::ranges::all_of(reached.values(), [](float weight) { return weight > 0.0f; })) return true;
    one_object_.assign(picture.pixel_count(), 1);
    views_.clear();
    for (std::uint32_t c = 0; c < picture.components(); ++c) {
        views_.push_back({picture.plane(c).data(), picture.width()});
    }
    return pyramid_.run(reached, one_object_, views_, context);
}

}  // namespace tessera::filter
