#pragma once

#include <vector>

#include "mediator/base/rect.h"
#include "tests/bench/filters/display.h"

namespace tessera::tools::bench {

// The place of the given size (or the whole picture, where that is smaller) with the most detail: the largest
// sum of differences between neighbouring shown pixels.
Rect most_detailed(const frame::Image& reference, std::int32_t width, std::int32_t height);

frame::Image cropped(const frame::Image& picture, const Rect& crop);

}  // namespace tessera::tools::bench
