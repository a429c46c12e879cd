#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace tessera::tools::bench {

// 8-bit RGB to draw on, rows from the top.
struct Canvas {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgb;

    Canvas(std::uint32_t w, std::uint32_t h, std::uint8_t grey)
        : width(w), height(h), rgb(std::size_t{w} * h * 3, grey) {}
    void set(std::uint32_t x, std::uint32_t y, std::uint8_t grey);  // outside: nothing
    void paste(const std::vector<std::uint8_t>& picture, std::uint32_t picture_width, std::uint32_t left,
               std::uint32_t top);  // which lies inside
};

inline constexpr std::uint32_t GlyphAdvance = 6, GlyphHeight = 8;  // pixels, at scale 1

// Lower-case letters, digits and the marks of numbers and options; what it has not is a gap. Cut at the right
// border.
void draw_text(Canvas& canvas, std::uint32_t left, std::uint32_t top, std::uint32_t scale,
               std::string_view text);

}  // namespace tessera::tools::bench
