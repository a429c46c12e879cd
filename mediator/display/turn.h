#pragma once

#include <cstddef>

#include "mediator/display/display.h"

namespace tessera::display {

// Whether the picture's width is along the device's height.
inline bool swaps_edges(Turn turn) {
    return turn == Turn::Quarter || turn == Turn::ThreeQuarters;
}

struct PixelPosition {
    std::size_t x = 0, y = 0;
};

// The pixel of the upright picture that a pixel of the device's width x height picture shows, both from the top
// left: with the device turned by a quarter, its top edge is on the right.
inline PixelPosition upright_position(Turn turn, PixelPosition at, std::size_t width, std::size_t height) {
    switch (turn) {
        case Turn::None:
            break;
        case Turn::Quarter:
            return {height - 1 - at.y, at.x};
        case Turn::Half:
            return {width - 1 - at.x, height - 1 - at.y};
        case Turn::ThreeQuarters:
            return {at.y, width - 1 - at.x};
    }
    return at;
}

}  // namespace tessera::display
