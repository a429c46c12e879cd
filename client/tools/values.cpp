#include "client/tools/values.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace tessera::tools {

namespace {

constexpr std::uint32_t MaxEdge = 65536;

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    while (true) {
        const std::size_t end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

// The whole text as one number.
template <class T>
std::optional<T> number(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || text.empty()) return std::nullopt;
    if constexpr (std::is_floating_point_v<T>) {
        if (!std::isfinite(value)) return std::nullopt;
    }
    return value;
}

tl::unexpected<Error> wrong(std::string_view text, const std::string& hint) {
    return failure(ErrorCode::InvalidInput, "'" + std::string(text) + "' " + hint);
}

}  // namespace

std::vector<std::string> split_list(std::string_view text) {
    std::vector<std::string> items;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t comma = std::min(text.find(',', from), text.size());
        if (comma > from) items.emplace_back(text.substr(from, comma - from));
        from = comma + 1;
    }
    return items;
}

Expected<std::uint32_t> parse_layers(std::string_view text) {
    std::uint32_t mask = 0;
    for (const std::string_view part : split(text, ',')) {
        const auto layer = number<std::uint32_t>(part);
        if (!layer || *layer > 31)
            return wrong(text, "is not a list of object layers; write numbers from 0 to 31, like 0,2");
        mask |= 1u << *layer;
    }
    return mask;
}

Expected<Size> parse_size(std::string_view text) {
    const auto parts = split(text, 'x');
    const auto width = number<std::uint32_t>(parts[0]);
    const auto height = parts.size() == 2 ? number<std::uint32_t>(parts[1]) : std::nullopt;
    if (!width || !height) return wrong(text, "is not a size; write it like 1280x720");
    if (*width == 0 || *height == 0 || *width > MaxEdge || *height > MaxEdge) {
        return wrong(text, "is out of range; width and height must be 1 to 65536 pixels");
    }
    return Size{*width, *height};
}

Expected<Rect> parse_crop(std::string_view text, Size picture) {
    const auto parts = split(text, ',');
    std::int32_t values[4]{};
    for (std::size_t i = 0; i < 4; ++i) {
        const auto value = i < parts.size() ? number<std::int32_t>(parts[i]) : std::nullopt;
        if (!value || parts.size() != 4)
            return wrong(text, "is not a crop window; write X,Y,W,H in pixels, like 0,0,320,240");
        values[i] = *value;
    }
    const Rect crop{values[0], values[1], values[2], values[3]};
    const std::int64_t right = std::int64_t{crop.x} + crop.width, bottom = std::int64_t{crop.y} + crop.height;
    if (crop.width < 1 || crop.height < 1)
        return wrong(text, "is an empty crop window; write X,Y,W,H, like 0,0,320,240");
    if (crop.x < 0 || crop.y < 0 || right > picture.width || bottom > picture.height) {
        return wrong(text, "exceeds the picture of " + std::to_string(picture.width) + "x" +
                               std::to_string(picture.height) + " pixels");
    }
    return crop;
}

Expected<glm::vec3> parse_color(std::string_view text) {
    const auto parts = split(text, ',');
    glm::vec3 color{};
    for (int i = 0; i < 3; ++i) {
        const std::string_view part = parts.size() == 1   ? parts[0]
                                      : parts.size() == 3 ? parts[std::size_t(i)]
                                                          : "";
        const auto value = number<float>(part);
        if (!value || *value < 0.0f) {
            return wrong(text, "is not a colour; write R,G,B as linear radiance, like 0.5,0.7,1");
        }
        color[i] = *value;
    }
    return color;
}

Expected<FrameRange> parse_frames(std::string_view text) {
    constexpr std::uint32_t Last = 9'999'999;
    const auto parts = split(text, ':');
    const auto first = number<std::uint32_t>(parts[0]), last = number<std::uint32_t>(parts.back());
    if (parts.size() > 2 || !first || !last || *first > *last || *last > Last)
        return wrong(text, "is not a range of frames; write the first and the last, like 0:47");
    return FrameRange{*first, *last};
}

Expected<Duration> parse_duration(std::string_view text) {
    const std::string hint = "is not a time; write it with its unit, like 800ms, 2.5s or 3m";
    const std::size_t unit_at = text.find_first_not_of("0123456789.");
    if (unit_at == std::string_view::npos) return wrong(text, hint);
    const auto value = number<double>(text.substr(0, unit_at));
    const std::string_view unit = text.substr(unit_at);
    const double scale = unit == "ms"                   ? 1e-3
                         : unit == "s"                  ? 1.0
                         : unit == "m" || unit == "min" ? 60.0
                         : unit == "h"                  ? 3600.0
                                                        : 0.0;
    if (!value || scale == 0.0) return wrong(text, hint);
    constexpr double Longest = 30.0 * 24 * 3600;
    const double in_seconds = *value * scale;
    if (!(in_seconds >= 1e-3 && in_seconds <= Longest))
        return wrong(text, "is out of range; must be 1ms to 720h");
    return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(in_seconds));
}

Expected<NodeWait> parse_node_wait(std::string_view text) {
    const auto parts = split(text, ':');
    NodeWait wait;
    const auto nodes = number<std::uint32_t>(parts[0]);
    const auto limit = parts.size() == 2 ? number<double>(parts[1]) : seconds(wait.limit);
    if (!nodes || *nodes == 0 || *nodes > 100000 || parts.size() > 2 || !limit || *limit < 0.0 ||
        *limit > 1e6) {
        return wrong(text, "is not a number of nodes; write N or N:seconds, like 2:30");
    }
    wait.nodes = *nodes;
    wait.limit = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(*limit));
    return wait;
}

Expected<PixelPosition> parse_pixel(std::string_view text, Size picture) {
    const auto parts = split(text, ',');
    const auto x = number<std::uint32_t>(parts[0]);
    const auto y = parts.size() == 2 ? number<std::uint32_t>(parts[1]) : std::nullopt;
    if (!x || !y) return wrong(text, "is not a pixel; write X,Y from the top left, like 320,180");
    if (*x >= picture.width || *y >= picture.height) {
        return wrong(text, "is outside the picture of " + std::to_string(picture.width) + "x" +
                               std::to_string(picture.height) + " pixels");
    }
    return PixelPosition{*x, *y};
}

}  // namespace tessera::tools
