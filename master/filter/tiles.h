#pragma once

#include <algorithm>
#include <cstdint>

#include "master/filter/pack.h"
#include "mediator/filter/planes.h"

// Windows without special cases at borders: a tile is copied with its margin, and pixels outside the picture
// get a value without weight.
namespace tessera::filter {

struct Tile {
    std::uint32_t x, y, width, height;
    std::uint32_t packs() const { return (width + PackSize - 1) / PackSize; }
};

// Fixed tiles, so that results do not depend on threads.
class Tiles {
  public:
    Tiles(std::uint32_t width, std::uint32_t height) : width_(width), height_(height) {}
    static constexpr std::uint32_t Width = 64, Height = 32;

    std::uint32_t count() const { return across() * ((height_ + Height - 1) / Height); }
    Tile tile(std::uint32_t index) const {
        const std::uint32_t x = index % across() * Width, y = index / across() * Height;
        return {x, y, std::min(Width, width_ - x), std::min(Height, height_ - y)};
    }

  private:
    std::uint32_t across() const { return (width_ + Width - 1) / Width; }
    std::uint32_t width_, height_;
};

// fill(y, first, last, to): writes the pixels [first, last) of row y to `to`. Called for rows y0 .. y0 + rows
// within the picture; everything else of the window becomes `outside`.
template <class Fill>
void copy_window(std::uint32_t width, std::uint32_t height, std::int64_t x0, std::int64_t y0,
                 std::uint32_t columns, std::uint32_t rows, float* to, std::size_t stride, float outside,
                 const Fill& fill) {
    const std::int64_t first = std::max<std::int64_t>(0, x0);
    const std::int64_t last = std::min<std::int64_t>(width, x0 + columns);
    for (std::uint32_t row = 0; row < rows; ++row, to += stride) {
        const std::int64_t y = y0 + row;
        if (y < 0 || y >= height || first >= last) {
            std::fill(to, to + columns, outside);
            continue;
        }
        std::fill(to, to + (first - x0), outside);
        fill(static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(first),
             static_cast<std::uint32_t>(last), to + (first - x0));
        std::fill(to + (last - x0), to + columns, outside);
    }
}

}  // namespace tessera::filter
