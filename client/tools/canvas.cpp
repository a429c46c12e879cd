#include "client/tools/canvas.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "mediator/display/pixel_font.h"

namespace tessera::tools {

namespace {

// The pixels from `least` to `most`, clipped to [0, size).
struct Range {
    std::int64_t begin, end;
};
Range clipped(double least, double most, std::uint32_t size) {
    const double low = std::clamp(std::floor(least), 0.0, double(size));
    const double high = std::clamp(std::ceil(most), 0.0, double(size));
    return {std::int64_t(low), std::int64_t(high)};
}

}  // namespace

void Canvas::mix(std::int64_t x, std::int64_t y, const Rgb& color, double coverage) {
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    std::uint8_t* const pixel = rgb.data() + (std::size_t(y) * width + std::size_t(x)) * 3;
    for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = std::uint8_t(std::lround(pixel[c] + (double(color[c]) - pixel[c]) * coverage));
}

void Canvas::paste(const std::vector<std::uint8_t>& picture, std::uint32_t picture_width, std::uint32_t left,
                   std::uint32_t top) {
    const std::size_t row = std::size_t{picture_width} * 3;
    for (std::size_t y = 0; y * row < picture.size(); ++y) {
        std::copy_n(picture.begin() + static_cast<std::ptrdiff_t>(y * row), row,
                    rgb.begin() + static_cast<std::ptrdiff_t>(((top + y) * width + left) * 3));
    }
}

void draw_text(Canvas& canvas, std::int64_t left, std::int64_t top, std::uint32_t scale,
               std::string_view text, const Rgb& color) {
    for (std::uint32_t y = 0; y < display::GlyphHeight * scale; ++y) {
        for (std::uint32_t x = 0; x < text_width(scale, text); ++x) {
            if (display::is_in_text(text, x / scale, y / scale)) canvas.mix(left + x, top + y, color, 1.0);
        }
    }
}

std::uint32_t text_width(std::uint32_t scale, std::string_view text) {
    return display::GlyphAdvance * scale * static_cast<std::uint32_t>(text.size());
}

void draw_line(Canvas& canvas, const glm::dvec2& from, const glm::dvec2& to, double width, const Rgb& color,
               double coverage) {
    const glm::dvec2 direction = to - from;
    const double length = glm::dot(direction, direction), half = 0.5 * width;
    const Range columns =
        clipped(std::min(from.x, to.x) - half - 1, std::max(from.x, to.x) + half + 1, canvas.width);
    const Range rows =
        clipped(std::min(from.y, to.y) - half - 1, std::max(from.y, to.y) + half + 1, canvas.height);
    for (std::int64_t y = rows.begin; y < rows.end; ++y) {
        for (std::int64_t x = columns.begin; x < columns.end; ++x) {
            const glm::dvec2 at(double(x) + 0.5, double(y) + 0.5);
            const double t =
                length > 0.0 ? std::clamp(glm::dot(at - from, direction) / length, 0.0, 1.0) : 0.0;
            const double inside = std::clamp(half + 0.5 - glm::distance(at, from + t * direction), 0.0, 1.0);
            if (inside > 0.0) canvas.mix(x, y, color, inside * coverage);
        }
    }
}

void fill_polygon(Canvas& canvas, std::span<const glm::dvec2> corners, const Rgb& color, double coverage) {
    constexpr int Subrows = 4;
    if (corners.empty()) return;
    const auto [low, high] = std::ranges::minmax(corners, {}, [](const glm::dvec2& c) { return c.y; });
    const Range rows = clipped(low.y, high.y, canvas.height);
    std::vector<double> crossings, covered(canvas.width);
    for (std::int64_t y = rows.begin; y < rows.end; ++y) {
        std::ranges::fill(covered, 0.0);
        for (int sub = 0; sub < Subrows; ++sub) {
            const double line = double(y) + (sub + 0.5) / Subrows;
            crossings.clear();
            for (std::size_t i = 0; i < corners.size(); ++i) {
                const glm::dvec2 &a = corners[i], &b = corners[(i + 1) % corners.size()];
                if ((a.y <= line) != (b.y <= line))
                    crossings.push_back(a.x + (line - a.y) / (b.y - a.y) * (b.x - a.x));
            }
            std::ranges::sort(crossings);
            for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
                const Range columns = clipped(crossings[i], crossings[i + 1], canvas.width);
                for (std::int64_t x = columns.begin; x < columns.end; ++x) {
                    const double from = std::max(crossings[i], double(x));
                    covered[std::size_t(x)] += std::min(crossings[i + 1], double(x) + 1.0) - from;
                }
            }
        }
        for (std::size_t x = 0; x < covered.size(); ++x) {
            if (covered[x] > 0.0)
                canvas.mix(std::int64_t(x), y, color, coverage * std::min(1.0, covered[x] / Subrows));
        }
    }
}

}  // namespace tessera::tools
