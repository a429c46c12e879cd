#pragma once

#include <cstdint>

namespace tessera::picture {

inline constexpr std::int64_t MaxPicturePixels = std::int64_t{64} << 20;

// What a picture may claim before memory is allocated for it.
struct PictureLimits {
    std::int64_t side = MaxPicturePixels;  // of the longer side, in pixels
    std::int64_t pixels = MaxPicturePixels;
};

}  // namespace tessera::picture
