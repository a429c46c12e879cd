#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "mediator/base/rect.h"

// The TCP protocol by which the image viewer tev is controlled. A packet is its length in bytes, itself included, as 32 bits;
// a byte for its kind; and its fields. Numbers are little-endian, texts end with a zero.
namespace tessera::tools::tev {

using Packet = std::vector<std::byte>;

// A black picture with these channels; one of the same name is replaced.
Packet create_image(const std::string& name, std::uint32_t width, std::uint32_t height,
                    std::span<const std::string> channels);

// New values of a part of these channels; `planes`: of one channel after another, row by row from the top.
Packet update_image(const std::string& name, std::span<const std::string> channels, const Rect& part,
                    std::span<const float> planes);

}  // namespace tessera::tools::tev
