#include "tests/process/screen.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

#include "tests/process/display_cluster.h"

namespace tessera::test {

namespace {

using namespace std::chrono_literals;

// Words of an XWD file's header (X11/XWDFile.h), which are big-endian.
enum Word { HeaderSize = 0, ByteOrder = 7, BitsPerPixel = 11, BytesPerLine = 12, Colors = 19 };
constexpr std::size_t ColorBytes = 12;

std::uint32_t word(const std::string& file, Word which) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
        value = value << 8 | static_cast<std::uint8_t>(file.at(4 * static_cast<std::size_t>(which) + i));
    return value;
}

}  // namespace

Screen::Screen(const TemporaryFolder& folder)
    : frame_buffer_(folder / "Xvfb_screen0"),
      server_(
          folder.path(), "screen", "Xvfb",
          {"-displayfd", "1", "-fbdir", folder.path().string(), "-screen", "0",
           std::to_string(Width) + "x" + std::to_string(Height) + "x24", "-nolisten", "tcp", "-noreset"}) {
    EXPECT_TRUE(happens([&] { return server_.out().ends_with('\n'); })) << server_.err();
    number_ = server_.out().substr(0, server_.out().find('\n'));
}

// It removes its lock files.
Screen::~Screen() {
    server_.signal(SIGTERM);
    (void)server_.wait(10s);
}

std::vector<std::uint8_t> Screen::pixels(int x, int y, int width, int height) const {
    std::ifstream stream(frame_buffer_, std::ios::binary);
    const std::string file((std::istreambuf_iterator<char>(stream)), {});
    EXPECT_EQ(word(file, BitsPerPixel), 32u);
    EXPECT_EQ(word(file, ByteOrder), 0u) << "the least significant byte is not first";
    const std::size_t start = word(file, HeaderSize) + word(file, Colors) * ColorBytes;
    std::vector<std::uint8_t> rgb;
    for (int row = y; row < y + height; ++row) {
        for (int column = x; column < x + width; ++column) {
            const std::size_t pixel = start + static_cast<std::size_t>(row) * word(file, BytesPerLine) +
                                      4 * static_cast<std::size_t>(column);
            for (const std::size_t byte : {2, 1, 0})  // blue is stored first
                rgb.push_back(static_cast<std::uint8_t>(file.at(pixel + byte)));
        }
    }
    return rgb;
}

}  // namespace tessera::test
