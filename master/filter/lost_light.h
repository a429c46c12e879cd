#pragma once

#include <array>
#include <span>
#include <vector>

#include "master/filter/scratch.h"

namespace tessera::filter {

// Gives a picture back the light that a filter or a blend took from it.
//
// What the whole picture lost of a component, D = sum (U - out), U being the unfiltered picture, is known far better than
// what a pixel lost: D^2 exceeds the variance of D by the square of the loss. That variance is at most
// v = min(sum V, sum D_t^2), where V is that of U and D_t the loss of a tile of 16 x 16 pixels, since the picture takes most
// of the noise of U over. So the part 1 - v / max(D^2, v) of D is given back.
//
// Alpha gets the mean part of the light's: its variance is not known.
class LostLight {
  public:
    static constexpr std::uint32_t TileSize = 16;

    // Each pixel gets its share in proportion to `noise` times its alpha. Pixels with n < 2 neither lose nor get
    // light. Light stays at or above 0, alpha in [0, 1]. `filtered_part`: the channel whose variance U has. False:
    // stopped; the picture is undefined.
    bool restore(const Inputs& inputs, frame::Channel filtered_part, std::span<const float> noise,
                 Planes& picture, RunContext& context);

  private:
    struct Loss {
        std::array<double, 4> light{};
        std::array<double, 4> square{};  // of the light of tiles
        std::array<double, 3> variance{};
        double noise = 0.0;

        void add(const Loss& other);
        std::array<float, 4> per_noise() const;
    };

    static void add_row(const Inputs& inputs, frame::Channel filtered_part, std::span<const float> noise,
                        const Planes& picture, std::uint32_t y, Loss& loss, double* tiles);

    std::vector<Loss> losses_;   // by row of tiles
    std::vector<double> tiles_;  // 4 by tile
};

}  // namespace tessera::filter
