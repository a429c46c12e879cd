#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tessera::frame {

// Resolved values, interleaved, rows from the top. No statistics.
struct Image {
    std::uint32_t width = 0, height = 0, components = 0;
    std::vector<float> values;  // width x height x components

    Image() = default;
    Image(std::uint32_t w, std::uint32_t h, std::uint32_t c)
        : width(w), height(h), components(c), values(std::size_t{w} * h * c) {}
    std::size_t pixel_count() const { return std::size_t{width} * height; }
    std::span<float> pixel(std::size_t index) { return {values.data() + index * components, components}; }
    std::span<const float> pixel(std::size_t index) const {
        return {values.data() + index * components, components};
    }
};

}  // namespace tessera::frame
