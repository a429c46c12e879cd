#include "client/tools/frame_names.h"

namespace tessera::tools {

std::optional<std::string> frame_name(const std::string& pattern, std::uint32_t frame) {
    const std::size_t begin = pattern.find('%');
    if (begin == std::string::npos || pattern.find('%', begin + 1) != std::string::npos) return std::nullopt;
    std::size_t end = begin + 1, width = 0;
    if (end + 1 < pattern.size() && pattern[end] == '0' && pattern[end + 1] >= '1' &&
        pattern[end + 1] <= '9') {
        width = static_cast<std::size_t>(pattern[end + 1] - '0');
        end += 2;
    }
    if (end >= pattern.size() || pattern[end] != 'd') return std::nullopt;
    std::string number = std::to_string(frame);
    if (number.size() < width) number.insert(0, width - number.size(), '0');
    return pattern.substr(0, begin) + number + pattern.substr(end + 1);
}

}  // namespace tessera::tools
