#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/error.h"
#include "mediator/base/rect.h"

// Parses the values of command-line options. Errors quote the value and show a valid one.
namespace tessera::tools {

struct Size {
    std::uint32_t width = 0, height = 0;
};
struct PixelPosition {
    std::uint32_t x = 0, y = 0;
};
struct NodeWait {
    std::uint32_t nodes = 1;
    Duration limit = std::chrono::seconds(60);
};
struct FrameRange {
    std::uint32_t first = 0, last = 0;  // both are rendered
};

std::vector<std::string> split_list(std::string_view text);  // "a,b": the non-empty parts between commas

Expected<Size> parse_size(std::string_view text);                // "1280x720", edges of 1 to 65536
Expected<Rect> parse_crop(std::string_view text, Size picture);  // "X,Y,W,H" inside the picture
Expected<glm::vec3> parse_color(std::string_view text);     // "R,G,B", finite and not negative; or one number
Expected<Duration> parse_duration(std::string_view text);   // "800ms", "2.5s", "3m", "1h", above zero
Expected<NodeWait> parse_node_wait(std::string_view text);  // "N" or "N:seconds"
Expected<std::uint32_t> parse_layers(
    std::string_view text);                                // "0,2", each of 0 to 31: a mask, bit i is layer i
Expected<FrameRange> parse_frames(std::string_view text);  // "A:B" with A <= B, or "A" for one; up to 9999999
Expected<PixelPosition> parse_pixel(std::string_view text, Size picture);  // "X,Y" inside the picture

}  // namespace tessera::tools
