#pragma once

#include "tests/filter/synthetic.h"

namespace tessera::filter {

// Pictures to measure whether a filter is consistent: SYN-1, whose edges features show, and light whose fine
// texture no feature shows, with exponentially distributed samples.
enum class ConsistencyScene { ShadowedTexture, LightTexture };

// relMSE of the filtered picture over that of the unfiltered, 96 x 54, n samples per pixel.
double error_ratio(const std::string& choice, ConsistencyScene scene, std::uint64_t n);

}  // namespace tessera::filter
