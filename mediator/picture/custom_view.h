#pragma once

#include <functional>
#include <span>
#include <string>

namespace tessera::picture {

// Replaces the view transform of a PNG or JPEG, for example by one of OpenColorIO.
struct CustomView {
    std::string name;
    // Interleaved RGB, in place: scene-linear Rec. 709 after exposure to the encoded values of the display in [0, 1].
    std::function<void(std::span<float> rgb)> apply;
};

}  // namespace tessera::picture
