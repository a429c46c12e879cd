#include "client/tools/terminal_picture.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <array>

namespace tessera::tools {

namespace {

using Color = std::array<std::uint8_t, 3>;

void set_color(std::string& out, const char* ground, const Color& color) {
    out += "\x1b[";
    out += ground;
    for (const std::uint8_t part : color) out += ";" + std::to_string(part);
    out += "m";
}

}  // namespace

std::string terminal_picture(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgb) {
    const auto at = [&](std::uint32_t x, std::uint32_t y) -> Color {
        if (y >= height) return {0, 0, 0};
        const std::size_t i = 3 * (std::size_t{y} * width + x);
        return {rgb[i], rgb[i + 1], rgb[i + 2]};
    };
    std::string out = "\x1b[H";
    for (std::uint32_t y = 0; y < height; y += 2) {
        Color last_upper{}, last_lower{};
        for (std::uint32_t x = 0; x < width; ++x) {
            const Color upper = at(x, y), lower = at(x, y + 1);
            if (x == 0 || upper != last_upper) set_color(out, "38;2", upper);
            if (x == 0 || lower != last_lower) set_color(out, "48;2", lower);
            out += "\u2580";  // upper half block
            last_upper = upper;
            last_lower = lower;
        }
        out += "\x1b[0m\x1b[K\n";
    }
    return out;
}

TerminalSize terminal_size() {
    winsize size{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {};
    return {size.ws_col, size.ws_row};
}

bool is_terminal() {
    return isatty(STDOUT_FILENO) != 0;
}

}  // namespace tessera::tools
