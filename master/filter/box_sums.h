#pragma once

#include <span>

#include "mediator/filter/planes.h"

namespace tessera::filter {

// Sums of components over squares of (2 radius + 1)^2 pixels, clipped to the picture, for a block of 2 radius + 1 rows:
// sums of the rows above the block's middle from below and of those below it from above, so that a row is added twice
// instead of 2 radius + 1 times. No sums are subtracted, which would leave the rounding of large values in small ones.
class BoxSums {
  public:
    static std::size_t rows_of(std::uint32_t radius) { return 2 * std::size_t{radius} + 1; }
    static std::uint32_t block_count(std::uint32_t height, std::uint32_t radius) {
        return (height + 2 * radius) / (2 * radius + 1);
    }
    // Numbers that one block needs.
    static std::size_t size(std::size_t width, std::uint32_t radius, std::size_t components) {
        return components * rows_of(radius) * width + 2 * (width + 2 * radius);
    }

    // Block `block` of `planes`; `memory` has size() numbers.
    BoxSums(const Planes& planes, std::span<const std::uint32_t> components, std::uint32_t block,
            std::uint32_t radius, float* memory);

    std::uint32_t first_row() const { return first_; }
    std::uint32_t row_count() const { return count_; }
    // Sums of component `components[i]` around the pixels of row first_row() + `row`.
    const float* row(std::size_t i, std::uint32_t row) const { return sums_ + (i * rows_ + row) * width_; }

  private:
    void add_rows(const Planes& planes, std::uint32_t component, std::uint32_t radius, float* below,
                  float* to) const;

    std::size_t width_, rows_;
    std::uint32_t first_, count_;
    float* sums_;
};

}  // namespace tessera::filter
