#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec2.hpp>

namespace tessera::display {

// A bilinear patch between four corners in the plane.
struct BilinearPatch {
    static constexpr double Rounding = 1e-7;

    std::array<glm::dvec2, 4> corners;  // at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1)

    // The (u, v) of a point, by Newton's method: in [0, 1] inside; NaN if there is none.
    glm::dvec2 inverse(const glm::dvec2& at) const;

    // Calls visit(x, y, uv) for every pixel of width x height whose centre (x + 0.5, y + 0.5) is inside,
    // or within rounding of an edge: neighbours leave no gap. None if corners are not finite.
    template <class Visit>
    void for_each_pixel(std::uint32_t width, std::uint32_t height, const Visit& visit) const {
        glm::dvec2 least = corners[0], most = least;
        for (const glm::dvec2& corner : corners) {
            if (!(std::isfinite(corner.x) && std::isfinite(corner.y))) return;
            least = glm::min(least, corner);
            most = glm::max(most, corner);
        }
        const auto first = [](double edge, std::uint32_t size) {
            return std::size_t(std::clamp(std::ceil(edge - 0.5 - Rounding), 0.0, double(size)));
        };
        const auto end = [](double edge, std::uint32_t size) {
            return std::size_t(std::clamp(std::floor(edge + 0.5 + Rounding), 0.0, double(size)));
        };
        for (std::size_t y = first(least.y, height); y < end(most.y, height); ++y)
            for (std::size_t x = first(least.x, width); x < end(most.x, width); ++x) {
                const glm::dvec2 uv = inverse({double(x) + 0.5, double(y) + 0.5});
                if (uv.x >= -Rounding && uv.y >= -Rounding && uv.x <= 1 + Rounding && uv.y <= 1 + Rounding)
                    visit(x, y, uv);
            }
    }
};

}  // namespace tessera::display
