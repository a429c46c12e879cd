#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mediator/base/rect.h"
#include "mediator/frame/image.h"

namespace tessera::picture {

// One EXR layer: the image's components under the given names; layer "" is the one that viewers show first.
struct Layer {
    std::string name;                     // "albedo"
    std::vector<std::string> components;  // "R", "G", "B": one per component of the image
    frame::Image image;
    bool as_integers = false;  // UINT: the image's floats are bit patterns of uint32
};

// 32-bit channels, ZIP. `window` is the part of the display (width x height) that the images cover.
// Attributes are strings. The file is never incomplete; throws Error{Io}.
void write_exr(const std::string& path, std::uint32_t width, std::uint32_t height, const Rect& window,
               const std::vector<Layer>& layers, const std::map<std::string, std::string>& attributes);

// How many threads of this process compress EXR files; 0, as at the start: the calling one.
void set_exr_threads(std::uint32_t count);

}  // namespace tessera::picture
