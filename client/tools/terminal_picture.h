#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace tessera::tools {

// A picture for a terminal with 24-bit colours, two pixels a character cell, one above the other. `rgb`: 3
// bytes a pixel, rows from the top. Starts in the upper left corner of the terminal, ends below the picture.
std::string terminal_picture(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgb);

struct TerminalSize {
    std::uint32_t columns = 80, rows = 24;
};
// Of standard output; the values above where it is no terminal.
TerminalSize terminal_size();
bool is_terminal();

}  // namespace tessera::tools
