#include "mediator/display/display.h"

namespace tessera::display {

bool takes_linear_light(const Output& output) {
    const bool mixes_eyes = output.stereo == Stereo::AnaglyphPlain || output.stereo == Stereo::AnaglyphDubois;
    return mixes_eyes || !output.points.empty() || output.blend != Blend{} || output.color != Color{};
}

bool is_somewhere(const Head& head) {
    constexpr double Farthest = 1e6;
    for (int i = 0; i < 3; ++i) {
        if (!(head.position[i] >= -Farthest && head.position[i] <= Farthest)) return false;
    }
    return true;
}

}  // namespace tessera::display
