#pragma once

#include "tests/filter/synthetic.h"

namespace tessera::filter {

// Pictures to measure consistency: SYN-1, whose edges are visible in the features, and finely textured light
// that no feature shows, with exponentially distributed samples.
enum class ConsistencyScene { ShadowedTexture, LightTexture };

// relMSE of the filtered picture over that of the unfiltered, 96 x 54, n samples per pixel.
double error_ratio(const std::string& choice, ConsistencyScene scene, std::uint64_t n);

}  // namespace tessera::filter
