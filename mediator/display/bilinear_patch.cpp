#include "mediator/display/bilinear_patch.h"

#include <limits>

namespace tessera::display {

glm::dvec2 BilinearPatch::inverse(const glm::dvec2& at) const {
    constexpr double Nowhere = std::numeric_limits<double>::quiet_NaN();
    const glm::dvec2 right = corners[1] - corners[0], down = corners[2] - corners[0],
                     twist = corners[3] - corners[2] - right;
    glm::dvec2 way(0.5);
    for (int step = 0; step < 12; ++step) {
        const glm::dvec2 off = corners[0] + way.x * right + way.y * down + way.x * way.y * twist - at;
        const glm::dvec2 by_x = right + way.y * twist, by_y = down + way.x * twist;
        const double area = by_x.x * by_y.y - by_x.y * by_y.x;
        if (area == 0.0) return glm::dvec2(Nowhere);
        const glm::dvec2 move((off.x * by_y.y - off.y * by_y.x) / area,
                              (by_x.x * off.y - by_x.y * off.x) / area);
        way -= move;
        if (std::abs(move.x) + std::abs(move.y) < 1e-9) return way;
    }
    return glm::dvec2(Nowhere);
}

}  // namespace tessera::display
