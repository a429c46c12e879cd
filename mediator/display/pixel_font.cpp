#include "mediator/display/pixel_font.h"

#include <algorithm>
#include <array>

namespace tessera::display {

namespace {

// 5 x 8 bits, the most significant is the top left.
struct Glyph {
    char character;
    std::uint64_t bits;
};
constexpr std::array Glyphs{
    Glyph{'a', 0x001c17c5e0}, Glyph{'b', 0x843d18c7c0},  Glyph{'c', 0x001d0841c0}, Glyph{'d', 0x085f18c5e0},
    Glyph{'e', 0x001d1fc1c0}, Glyph{'f', 0x323c842100},  Glyph{'g', 0x001f18bc2e}, Glyph{'h', 0x843d18c620},
    Glyph{'i', 0x20184211c0}, Glyph{'j', 0x100c210a4c},  Glyph{'k', 0x84254c5240}, Glyph{'l', 0x61084211c0},
    Glyph{'m', 0x00355ad6a0}, Glyph{'n', 0x003d18c620},  Glyph{'o', 0x001d18c5c0}, Glyph{'p', 0x003d18fa10},
    Glyph{'q', 0x001f18bc21}, Glyph{'r', 0x002d884200},  Glyph{'s', 0x001f0707c0}, Glyph{'t', 0x423c8420c0},
    Glyph{'u', 0x002318c5e0}, Glyph{'v', 0x002318a880},  Glyph{'w', 0x002b5ad540}, Glyph{'x', 0x0022a22a20},
    Glyph{'y', 0x002318bc2e}, Glyph{'z', 0x003e2223e0},  Glyph{'0', 0x74675cc5c0}, Glyph{'1', 0x23084211c0},
    Glyph{'2', 0x74426443e0}, Glyph{'3', 0x744260c5c0},  Glyph{'4', 0x11952f8840}, Glyph{'5', 0xfc3c10c5c0},
    Glyph{'6', 0x7421e8c5c0}, Glyph{'7', 0xf844421080},  Glyph{'8', 0x7462e8c5c0}, Glyph{'9', 0x7462f085c0},
    Glyph{'M', 0x8eeb58c620}, Glyph{'S', 0x7c20e087c0},  Glyph{'E', 0xfc21e843e0}, Glyph{'.', 0x0000003180},
    Glyph{',', 0x0000003088}, Glyph{'-', 0x0000e00000},  Glyph{'+', 0x0008e20000}, Glyph{':', 0x0018c03180},
    Glyph{'=', 0x003e0f8000}, Glyph{'/', 0x0844444200},  Glyph{'_', 0x00000003e0}, Glyph{' ', 0x0000000000},
    Glyph{'A', 0x7463f8c620}, Glyph{'B', 0xf463e8c7c0},  Glyph{'C', 0x74610845c0}, Glyph{'D', 0xf46318c7c0},
    Glyph{'F', 0xfc21e84200}, Glyph{'G', 0x746178c5e0},  Glyph{'H', 0x8c63f8c620}, Glyph{'I', 0x71084211c0},
    Glyph{'J', 0x3884214980}, Glyph{'K', 0x8ca98a4a20},  Glyph{'L', 0x84210843e0}, Glyph{'N', 0x8e6b59c620},
    Glyph{'O', 0x746318c5c0}, Glyph{'P', 0xf463e84200},  Glyph{'Q', 0x74631ac9a0}, Glyph{'R', 0xf463ea4a20},
    Glyph{'T', 0xf908421080}, Glyph{'U', 0x8c6318c5c0},  Glyph{'V', 0x8c6318a880}, Glyph{'W', 0x8c635ad540},
    Glyph{'X', 0x8c54454620}, Glyph{'Y', 0x8c54421080},  Glyph{'Z', 0xf8444443e0}, Glyph{'(', 0x1110841040},
    Glyph{')', 0x4104211100}, Glyph{'\'', 0x2100000000},
};

}  // namespace

bool is_in_text(std::string_view text, std::uint32_t x, std::uint32_t y) {
    const std::uint32_t index = x / GlyphAdvance, column = x % GlyphAdvance;
    if (index >= text.size() || column >= GlyphWidth || y >= GlyphHeight) return false;
    const auto glyph = std::ranges::find(Glyphs, text[index], &Glyph::character);
    return glyph != Glyphs.end() && (glyph->bits >> (39 - (y * GlyphWidth + column)) & 1u) != 0;
}

}  // namespace tessera::display
