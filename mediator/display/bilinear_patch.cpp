#include "mediator/display/bilinear_patch.h"

#include <limits>

namespace tessera::display {

glm::dvec2 BilinearPatch::inverse(const glm::dvec2& at) const {
    constexpr double Nowhere = std::numeric_limits<double>::quiet_NaN();
    const glm::dvec2 right = corners[1] - corners[0], down = corners[2] - corners[0],
                     twist = corners[3] - corners[2] - right;
    glm::dvec2 uv(0.5);
    for (int step = 0; step < 12; ++step) {
        const glm::dvec2 off = corners[0] + uv.x * right + uv.y * down + uv.x * uv.y * twist - at;
        const glm::dvec2 by_x = right + uv.y * twist, by_y = down + uv.x * twist;
        const double area = by_x.x * by_y.y - by_x.y * by_y.x;
        if (area == 0.0) return glm::dvec2(Nowhere);
        const glm::dvec2 move((off.x * by_y.y - off.y * by_y.x) / area,
                              (by_x.x * off.y - by_x.y * off.x) / area);
        uv -= move;
        if (std::abs(move.x) + std::abs(move.y) < 1e-9) return uv;
    }
    return glm::dvec2(Nowhere);
}

}  // namespace tessera::display
