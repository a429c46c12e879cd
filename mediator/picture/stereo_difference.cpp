#include "mediator/picture/stereo_difference.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <optional>

#include "mediator/picture/color.h"

namespace tessera::picture {

namespace {

double luminance_at(const EyeView& eye, std::size_t i) {
    return luminance(eye.red[i], eye.green[i], eye.blue[i]);
}

struct SurfaceSample {
    double luminance = 0.0;
    double depth = 0.0;
};

// Bilinear between pixel centers; empty outside the picture or next to a pixel without a surface.
std::optional<SurfaceSample> read(const EyeView& eye, double x, double y) {
    const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
    if (!(left >= 0.0 && top >= 0.0 && left + 1.0 < eye.width && top + 1.0 < eye.height)) return std::nullopt;
    const double s = x - 0.5 - left, t = y - 0.5 - top;
    const auto first = static_cast<std::size_t>(top) * eye.width + static_cast<std::size_t>(left);
    SurfaceSample seen;
    for (const int corner : {0, 1, 2, 3}) {
        const std::size_t i =
            first + static_cast<std::size_t>(corner & 1) + (corner & 2 ? std::size_t{eye.width} : 0);
        if (!std::isfinite(eye.depth[i])) return std::nullopt;
        const double weight = (corner & 1 ? s : 1.0 - s) * (corner & 2 ? t : 1.0 - t);
        seen.luminance += weight * luminance_at(eye, i);
        seen.depth += weight * eye.depth[i];
    }
    return seen;
}

}  // namespace

StereoDifference stereo_difference(const EyeView& left, const EyeView& right) {
    constexpr double DepthTolerance = 0.01;
    const std::size_t pixels = std::size_t{left.width} * left.height;
    double mean_luminance = 0.0;
    for (std::size_t i = 0; i < pixels; ++i) mean_luminance += luminance_at(left, i);
    mean_luminance /= static_cast<double>(std::max<std::size_t>(pixels, 1));
    const double black = 1e-3 * mean_luminance;
    const glm::dmat4 right_from_left =
        glm::inverse(right.camera.world_from_camera) * left.camera.world_from_camera;
    const view::CameraPose &from = left.camera, &to = right.camera;
    double sum = 0.0;
    std::size_t compared = 0, surfaces = 0;
    for (std::uint32_t y = 0; y < left.height; ++y) {
        for (std::uint32_t x = 0; x < left.width; ++x) {
            const std::size_t i = std::size_t{y} * left.width + x;
            const double depth = left.depth[i];
            if (!std::isfinite(depth)) continue;
            ++surfaces;
            const double u = from.left + (from.right - from.left) * (x + 0.5) / left.width;
            const double v = from.top + (from.bottom - from.top) * (y + 0.5) / left.height;
            const glm::dvec4 point = right_from_left * glm::dvec4(u * depth, v * depth, -depth, 1.0);
            if (!(point.z < 0.0)) continue;
            const double there_x = (point.x / -point.z - to.left) / (to.right - to.left) * right.width;
            const double there_y = (point.y / -point.z - to.top) / (to.bottom - to.top) * right.height;
            const auto seen = read(right, there_x, there_y);
            if (!seen || std::abs(seen->depth + point.z) > DepthTolerance * -point.z) continue;
            const double here = luminance_at(left, i);
            const double total = here + seen->luminance + 2.0 * black;
            if (total > 0.0) sum += std::abs(here - seen->luminance) / total;
            ++compared;
        }
    }
    if (compared == 0) return {};
    return {sum / static_cast<double>(compared),
            static_cast<double>(compared) / static_cast<double>(surfaces)};
}

}  // namespace tessera::picture
