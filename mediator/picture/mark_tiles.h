#pragma once

#include <span>

#include "mediator/base/rect.h"
#include "mediator/frame/image.h"

namespace tessera::picture {

// Covers tiles that have no samples with magenta stripes that no scene is mistaken for. `exposure`: EV with which the
// image will be shown; (`left`, `top`): the picture's pixel that the image begins with.
void mark_tiles(frame::Image& image, std::span<const Rect> tiles, double exposure, std::int32_t left,
                std::int32_t top);

}  // namespace tessera::picture
