#include "mediator/display/display.h"

namespace tessera::display {

bool takes_linear_light(const Output& output) {
    const bool mixes_eyes = output.stereo == Stereo::AnaglyphPlain || output.stereo == Stereo::AnaglyphDubois;
    return mixes_eyes || !output.points.empty() || output.blend != Blend{} || output.color != Color{};
}

}  // namespace tessera::display
