#include "mediator/display/display.h"

#include <cmath>
#include <limits>

namespace tessera::display {

bool takes_linear_light(const Output& output) {
    const bool mixes_eyes = output.stereo == Stereo::AnaglyphPlain || output.stereo == Stereo::AnaglyphDubois;
    return mixes_eyes || !output.points.empty() || output.blend != Blend{} || output.color != Color{};
}

const char* Head::malformed() const {
    const bool finite = glm::dot(position - position, position - position) == 0.0;
    const double length = glm::length(wxyz());
    return finite && length > 0.5 && length < 2.0
               ? nullptr
               : "the head's position is not finite, or its orientation is not a unit quaternion";
}

void Head::turn(const glm::dvec4& wxyz) {
    const double length = glm::length(wxyz);
    // What has been normalized is left as it is, so that it has the same bits after it was sent on.
    constexpr double Rounding = 4.0 * std::numeric_limits<double>::epsilon();
    const bool is_unit = std::abs(length - 1.0) <= Rounding;
    const glm::dvec4 unit = !is_unit && length > 0.5 && length < 2.0 ? wxyz / length : wxyz;
    orientation = glm::dquat(unit.x, unit.y, unit.z, unit.w);
}

bool has_valid_position(const Head& head) {
    constexpr double Farthest = 1e6;
    for (int i = 0; i < 3; ++i) {
        if (!(head.position[i] >= -Farthest && head.position[i] <= Farthest)) return false;
    }
    return true;
}

}  // namespace tessera::display
