#include "client/tools/bench/pixel_font.h"

#include <algorithm>
#include <array>

namespace tessera::tools::bench {

namespace {

// 5 x 8 bits, the most significant is the top left.
struct Glyph {
    char character;
    std::uint64_t bits;
};
constexpr std::array Glyphs{
    Glyph{'a', 0x001c17c5e0}, Glyph{'b', 0x843d18c7c0}, Glyph{'c', 0x001d0841c0}, Glyph{'d', 0x085f18c5e0},
    Glyph{'e', 0x001d1fc1c0}, Glyph{'f', 0x323c842100}, Glyph{'g', 0x001f18bc2e}, Glyph{'h', 0x843d18c620},
    Glyph{'i', 0x20184211c0}, Glyph{'j', 0x100c210a4c}, Glyph{'k', 0x84254c5240}, Glyph{'l', 0x61084211c0},
    Glyph{'m', 0x00355ad6a0}, Glyph{'n', 0x003d18c620}, Glyph{'o', 0x001d18c5c0}, Glyph{'p', 0x003d18fa10},
    Glyph{'q', 0x001f18bc21}, Glyph{'r', 0x002d884200}, Glyph{'s', 0x001f0707c0}, Glyph{'t', 0x423c8420c0},
    Glyph{'u', 0x002318c5e0}, Glyph{'v', 0x002318a880}, Glyph{'w', 0x002b5ad540}, Glyph{'x', 0x0022a22a20},
    Glyph{'y', 0x002318bc2e}, Glyph{'z', 0x003e2223e0}, Glyph{'0', 0x74675cc5c0}, Glyph{'1', 0x23084211c0},
    Glyph{'2', 0x74426443e0}, Glyph{'3', 0x744260c5c0}, Glyph{'4', 0x11952f8840}, Glyph{'5', 0xfc3c10c5c0},
    Glyph{'6', 0x7421e8c5c0}, Glyph{'7', 0xf844421080}, Glyph{'8', 0x7462e8c5c0}, Glyph{'9', 0x7462f085c0},
    Glyph{'M', 0x8eeb58c620}, Glyph{'S', 0x7c20e087c0}, Glyph{'E', 0xfc21e843e0}, Glyph{'.', 0x0000003180},
    Glyph{',', 0x0000003088}, Glyph{'-', 0x0000e00000}, Glyph{'+', 0x0008e20000}, Glyph{':', 0x0018c03180},
    Glyph{'=', 0x003e0f8000}, Glyph{'/', 0x0844444200}, Glyph{'_', 0x00000003e0}, Glyph{' ', 0x0000000000},
};

}  // namespace

void Canvas::set(std::uint32_t x, std::uint32_t y, std::uint8_t grey) {
    if (x >= width || y >= height) return;
    std::fill_n(rgb.begin() + static_cast<std::ptrdiff_t>((std::size_t{y} * width + x) * 3), 3, grey);
}

void Canvas::paste(const std::vector<std::uint8_t>& picture, std::uint32_t picture_width, std::uint32_t left,
                   std::uint32_t top) {
    const std::size_t row = std::size_t{picture_width} * 3;
    for (std::size_t y = 0; y * row < picture.size(); ++y) {
        std::copy_n(picture.begin() + static_cast<std::ptrdiff_t>(y * row), row,
                    rgb.begin() + static_cast<std::ptrdiff_t>(((top + y) * width + left) * 3));
    }
}

void draw_text(Canvas& canvas, std::uint32_t left, std::uint32_t top, std::uint32_t scale,
               std::string_view text) {
    for (const char character : text) {
        const auto glyph = std::find_if(Glyphs.begin(), Glyphs.end(),
                                        [&](const Glyph& g) { return g.character == character; });
        const std::uint64_t bits = glyph == Glyphs.end() ? 0 : glyph->bits;
        for (std::uint32_t y = 0; y < 8 * scale; ++y) {
            for (std::uint32_t x = 0; x < 5 * scale; ++x) {
                const std::uint32_t bit = 39 - (y / scale * 5 + x / scale);
                if (bits >> bit & 1u) canvas.set(left + x, top + y, 20);
            }
        }
        left += GlyphAdvance * scale;
    }
}

}  // namespace tessera::tools::bench
