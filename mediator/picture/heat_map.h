#pragma once

#include <cstdint>
#include <span>

#include "mediator/frame/image.h"

namespace tessera::picture {

// Values as colours on a logarithmic scale: `low` and less are black, then violet, red, orange, and `high` and more are
// white. Linear Rec. 709, 3 components; width x height values, row by row. 0 < low < high.
frame::Image heat_map(std::span<const float> values, std::uint32_t width, std::uint32_t height, float low,
                      float high);

}  // namespace tessera::picture
