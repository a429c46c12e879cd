#include "master/filter/box_sums.h"

#include <algorithm>

namespace tessera::filter {

namespace {

void add(const float* __restrict from, std::size_t count, float* __restrict to) {
    for (std::size_t x = 0; x < count; ++x) to[x] += from[x];
}

// Sums over 2 radius + 1 neighbours of a row, in place, by doubling: over 1, 2, 4, ... pixels, of which those are added
// that make up the number. `memory`: twice the row with `radius` pixels on either side.
void add_neighbours(std::size_t width, std::uint32_t radius, float* memory, float* row) {
    const std::size_t padded = width + 2 * std::size_t{radius};
    float* __restrict doubled = memory, * __restrict next = memory + padded;
    std::fill_n(doubled, radius, 0.0f);
    std::copy_n(row, width, doubled + radius);
    std::fill_n(doubled + radius + width, radius, 0.0f);
    std::fill_n(row, width, 0.0f);
    std::size_t from = 0, length = padded;
    for (std::uint32_t rest = 2 * radius + 1, pixels = 1; rest != 0; rest >>= 1, pixels <<= 1) {
        if ((rest & 1) != 0) {
            add(doubled + from, width, row);
            from += pixels;
        }
        if (rest == 1) break;
        length -= pixels;
        for (std::size_t x = 0; x < length; ++x) next[x] = doubled[x] + doubled[x + pixels];
        std::swap(doubled, next);
    }
}

}  // namespace

BoxSums::BoxSums(const Planes& planes, std::span<const std::uint32_t> components, std::uint32_t block,
                 std::uint32_t radius, float* memory)
    : width_(planes.width()), rows_(rows_of(radius)), first_(block * (2 * radius + 1)), sums_(memory) {
    count_ = std::min(planes.height() - first_, 2 * radius + 1);
    float* rest = memory + components.size() * rows_ * width_;
    for (std::size_t i = 0; i < components.size(); ++i) {
        float* sums = memory + i * rows_ * width_;
        add_rows(planes, components[i], radius, rest, sums);
        for (std::uint32_t y = 0; y < count_; ++y) add_neighbours(width_, radius, rest, sums + y * width_);
    }
}

void BoxSums::add_rows(const Planes& planes, std::uint32_t component, std::uint32_t radius, float* below,
                       float* to) const {
    // Relative to the first row that the block's first row needs.
    const auto source = [&](std::uint32_t row) -> const float* {
        const std::int64_t y = std::int64_t{first_} + row - radius;
        return y >= 0 && y < planes.height() ? planes.row(component, static_cast<std::uint32_t>(y)) : nullptr;
    };
    for (std::uint32_t row = 2 * radius + 1; row-- > 0;) {
        float* sum = to + row * width_;
        if (row < 2 * radius) {
            std::copy_n(sum + width_, width_, sum);
        } else {
            std::fill_n(sum, width_, 0.0f);
        }
        if (const float* values = source(row)) add(values, width_, sum);
    }
    std::fill_n(below, width_, 0.0f);
    for (std::uint32_t row = 1; row < count_; ++row) {
        if (const float* values = source(2 * radius + row)) add(values, width_, below);
        add(below, width_, to + row * width_);
    }
}

}  // namespace tessera::filter
