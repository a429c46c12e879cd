#pragma once

#include "master/filter/kernels.h"

namespace tessera::filter {

// How far the noise of two channels, such as radiance and root, is the same: their squared correlation per pixel, in [0, 1],
// over a square of pixels. The noise is taken to be the difference between the luminance of a pixel and that of its four
// neighbours, so that a gradient of the light does not count; edges do, so it is rather overestimated. 1 where there is no
// noise. Holes do not contribute.
class NoiseCorrelation {
  public:
    // Channels of 3 components; the square has (2 radius + 1)^2 pixels. False: stopped.
    bool run(const Inputs& inputs, frame::Channel a, frame::Channel b, std::uint32_t radius,
             RunContext& context);

    const Planes& squared() const { return squared_; }  // 1 component

    // Memory traffic of run() per pixel.
    static constexpr double Bytes = 4.0 * (6 + 2 + 2 + 2 + 2 + 1);

  private:
    Planes light_, residual_;  // 2 components: of each channel
    Planes squared_;
};

}  // namespace tessera::filter
