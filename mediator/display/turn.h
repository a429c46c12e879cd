#pragma once

#include <cstddef>

#include "mediator/display/display.h"

namespace tessera::display {

// Whether the picture's width lies along the device's height.
inline bool swaps_edges(Turn turn) {
    return turn == Turn::Quarter || turn == Turn::ThreeQuarters;
}

struct Place {
    std::size_t x = 0, y = 0;
};

// What place of the upright picture a place of a device's picture of width x height shows, counted from top
// left: with the device turned by a quarter, its top edge is on the right.
inline Place upright_place(Turn turn, Place at, std::size_t width, std::size_t height) {
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
