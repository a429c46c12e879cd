#pragma once

#include <string>

#include "mediator/base/error.h"
#include "mediator/frame/image.h"

namespace tessera::picture {

// Throws Error{InvalidInput} unless both have the same size and number of components, and are not empty.
inline void require_same_size(const frame::Image& picture, const frame::Image& reference) {
    const auto size = [](const frame::Image& image) {
        return std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels of " +
               std::to_string(image.components) + " components";
    };
    if (size(picture) != size(reference)) {
        throw Error(ErrorCode::InvalidInput, "the picture has " + size(picture) + ", the reference " +
                                                 size(reference) + ": compare pictures of one size");
    }
    if (picture.values.empty())
        throw Error(ErrorCode::InvalidInput, "the pictures are empty: there is nothing to compare");
}

}  // namespace tessera::picture
