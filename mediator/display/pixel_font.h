#pragma once

#include <cstdint>
#include <string_view>

namespace tessera::display {

// Letters, digits and some marks of 5 x 8 pixels, the last row for descenders; the advance includes a gap.
inline constexpr std::uint32_t GlyphWidth = 5, GlyphAdvance = 6, GlyphHeight = 8;

// Whether text that begins at (0, 0) covers the pixel; unknown characters are gaps.
bool is_in_text(std::string_view text, std::uint32_t x, std::uint32_t y);

}  // namespace tessera::display
