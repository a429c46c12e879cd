#pragma once

#include <tbb/task_arena.h>

#include <vector>

#include "mediator/frame/film_tile.h"

namespace tessera::picture {

// Error of an unfiltered picture, by its own samples: of every pixel the relative variance of its mean, whose mean over
// the picture is relMSE (mediator/picture/metrics.h).
//
// Per channel the variance of the mean, times its design effect (frame/design_effect.h), is divided by the expected r^2 + 0.01
// times the squared mean luminance. The brightness r is estimated from the pixel and its 5 x 5 neighbours, as far as these
// differ from it by noise alone. (With the neighbours' mean alone, the true noise of `grids` was 1.3 times the estimate: their
// shadows are a few pixels wide. Now it is 1.1 times.) For noise() a pixel is not one of its own neighbours: a bright find would
// be divided by the light that it brings. With it, true noise was 1.2 to 12 times the estimate in `still` and `caustics` with 16
// and 64 samples; with the true brightness it is 1.0 times everywhere, so the estimated variance is right. What is left is
// darkness that the neighbours do not have: finds in shadows.
//
// What a single pixel needs is known poorly. A bright find says little of it, so here the pixel is one of its neighbours, and the
// standard deviation of its samples is averaged over 9 x 9 pixels. Where light is found rarely, few pixels have nearly all the variance; averages of variances give their neighbours too many
// samples, and all others too few. relMSE of uniform sampling over that of pixels with n proportional to the estimate, by
// films of 16 and 64 samples of room-1, studio-1, still and interior-1, 96 x 54:
//
//     variance, the pixel's own       0.50 0.65    1.04 0.95    0.49 0.54    0.39 0.44
//     variance over 5 x 5             0.97 1.03    0.94 0.96    2.25 1.93    0.84 0.89
//     deviation over 5 x 5            0.99 1.02    1.44 1.47    1.83 2.39    0.90 0.95
//     deviation over 9 x 9            1.02 1.04    1.48 1.47    2.15 2.66    0.99 1.00
//     the true variance                 1.16         3.65         5.64         1.17
//
// What the variances of pixels exceed those squares by is partly light that few samples have found: the part 1 / finds of it,
// with finds = (sum x)^2 / sum x^2. Other pixels may find such light as well, so an eighth of its mean is added to each. (Added
// without regard to finds, a sixteenth gave 1.02 1.04, 1.42 1.41, 1.77 1.99 and 1.00 1.01 in the table above.)
class NoiseMap {
  public:
    // That it takes while it is made, or pixels are chosen by it.
    static constexpr std::size_t BytesPerPixel = 76;

    // Of a film of all pixels of its rectangle, with Radiance; pixels with fewer than two samples have the noise of their
    // neighbours.
    // Without an arena in this thread; the same bits either way.
    explicit NoiseMap(const frame::FilmTile& film, tbb::task_arena* arena = nullptr);

    // Estimated sqrt(relMSE). 0: no pixel has two samples, or there is no light.
    double noise() const { return noise_; }
    // Square root of the relMSE that a pixel would have with one sample, averaged.
    const std::vector<float>& deviations() const { return deviations_; }

  private:
    std::vector<float> deviations_;
    double noise_ = 0.0;
};

// Relative error of each pixel: its averaged deviation over the root of its samples; 0 with fewer than two.
std::vector<float> noise_of_pixels(const frame::FilmTile& film);

}  // namespace tessera::picture
