#pragma once

#include <vector>

#include "mediator/base/rect.h"
#include "tests/bench/filters/display.h"

namespace tessera::tools::bench {

// The rectangle of the given size (or the whole picture, if smaller) with the most detail: the largest sum of
// differences between neighbouring displayed pixels.
Rect most_detailed(const frame::Image& reference, std::int32_t width, std::int32_t height);

frame::Image cropped(const frame::Image& picture, const Rect& crop);

}  // namespace tessera::tools::bench
