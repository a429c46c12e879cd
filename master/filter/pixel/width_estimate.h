#pragma once

#include "master/filter/pixel/light.h"
#include "master/filter/pixel/sweep.h"

namespace tessera::filter::pixel {

struct AdaptiveWidths {
    float threshold = 0.01f;  // t
    float base = 8.0f;        // sigma_s, pixels
    float clamp = 4.0f;       // c
};

// Widths per pixel (Schwenk 3.15 to 3.17) need the smoothed variance and the surrounding light of a pixel
// before there is a filtered picture. They are estimated by one separable cross-bilateral iteration of the
// base width over luminance and variance alone, at every other pixel.
class WidthEstimate {
  public:
    bool run(const Guide& guide, const Light& light, const Inputs& inputs, const Field& field,
             const AdaptiveWidths& rule, Widths& widths, Strips& strips, RunContext& context);
    static constexpr double BytesPerPixel = 4.0 * (4 + 3 + 2 * (4 + 1 + 3 + 3) + 7);

  private:
    Field field_, scratch_;
};

}  // namespace tessera::filter::pixel
