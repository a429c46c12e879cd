#pragma once

#include <tbb/task_arena.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mediator/base/bands.h"
#include "mediator/frame/film_tile.h"

// What the pixels of a noisy picture are divided by where errors are relative to its brightness.
namespace tessera::picture {

// Rows of a picture, in bands; without an arena in this thread, with the same bits.
struct PixelRows {
    std::size_t width, height;
    tbb::task_arena* arena;
    static constexpr std::size_t BandRows = 16;

    // function(first, last) of the pixels of a band.
    template <class Function>
    void each(const Function& function) const {
        for_bands(arena, height, BandRows,
                  [&](std::size_t first, std::size_t last) { function(first * width, last * width); });
    }
};

// Sums over squares around each pixel, clipped to the picture; its own value is never subtracted, which would leave rounding.
class SquareSum {
  public:
    enum class Own : std::uint8_t { Included, LeftOut };

    explicit SquareSum(const PixelRows& rows) : rows_(rows) {}
    void apply(std::span<float> values, std::size_t radius, Own own = Own::Included);

  private:
    void sum_row(std::span<const float> values, std::size_t y, std::size_t radius, Own own,
                 std::vector<float>& padded);
    void add(float* to, const float* from) const {
        for (std::size_t x = 0; x < rows_.width; ++x) to[x] += from[x];
    }
    PixelRows rows_;
    std::vector<float> across_, across_others_;
};

// Squared brightness of each pixel in one component. Its mean is shrunk to that of its neighbours as far as their differences
// are noise (Wiener): a pixel that found little would count too much if it were divided by itself, and one in a fine shadow
// too little if it were divided by its neighbours. What is left of the variance is added: the square's expectation.
class Brightness {
  public:
    static constexpr std::size_t BytesPerPixel = 28;

    // `known`: 1 for pixels that count, else 0.
    Brightness(const PixelRows& rows, std::span<const float> known);

    // `variance`: of the mean, finite.
    void estimate(std::span<const float> mean, std::span<const float> variance);
    // With and without the pixel among its neighbours.
    std::span<const float> of_all() const { return value_; }
    std::span<const float> of_others() const { return others_; }

  private:
    void shrink(std::size_t i, float variance);

    PixelRows rows_;
    SquareSum squares_;
    std::span<const float> known_;
    std::vector<float> count_, value_, others_, sum_of_squares_, noise_;
};

// A tenth of the mean luminance, squared, as in relMSE (metrics.h). Of a film with Radiance.
float brightness_floor(const frame::FilmTile& film);

}  // namespace tessera::picture
