#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <string_view>
#include <vector>

namespace tessera::tools {

using Rgb = std::array<std::uint8_t, 3>;

// An 8-bit RGB raster, rows from the top. Drawing is clipped to it.
struct Canvas {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgb;

    Canvas(std::uint32_t w, std::uint32_t h, std::uint8_t grey)
        : width(w), height(h), rgb(std::size_t{w} * h * 3, grey) {}
    void mix(std::int64_t x, std::int64_t y, const Rgb& color, double coverage);
    void paste(const std::vector<std::uint8_t>& picture, std::uint32_t picture_width, std::uint32_t left,
               std::uint32_t top);  // must fit inside
};

void draw_text(Canvas& canvas, std::int64_t left, std::int64_t top, std::uint32_t scale,
               std::string_view text, const Rgb& color = {20, 20, 20});
std::uint32_t text_width(std::uint32_t scale, std::string_view text);

// Anti-aliased, `width` pixels wide.
void draw_line(Canvas& canvas, const glm::dvec2& from, const glm::dvec2& to, double width, const Rgb& color,
               double coverage = 1.0);

// Even-odd fill rule, anti-aliased.
void fill_polygon(Canvas& canvas, std::span<const glm::dvec2> corners, const Rgb& color, double coverage);

}  // namespace tessera::tools
