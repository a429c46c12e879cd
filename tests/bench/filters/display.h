#pragma once

#include <cstdint>
#include <vector>

#include "mediator/frame/image.h"

namespace tessera::tools::bench {

// Display transform for the pictures of one scene: exposure and white point are those of the reference, so
// that pictures of different filters are comparable. The curve of picture::tone_map.
class Display {
  public:
    explicit Display(const frame::Image& reference);

    frame::Image shown(const frame::Image& picture) const;                // linear, in [0, 1]
    std::vector<std::uint8_t> pixels(const frame::Image& picture) const;  // 8-bit sRGB

  private:
    double scale_ = 1.0, white_ = 1.0;
};

}  // namespace tessera::tools::bench
