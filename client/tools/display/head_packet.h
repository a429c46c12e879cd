#pragma once

#include <string_view>

#include "mediator/base/error.h"
#include "mediator/display/display.h"

namespace tessera::tools {

inline constexpr std::size_t MaxHeadPacket = 512;  // bytes

// Parses a tracker's UDP packet: a line "x y z" or "x y z qw qx qy qz", optionally after the word "head". Metres in
// display space; the quaternion is normalized and must not be zero; without one the head looks along -z. Packets are
// untrusted: error messages do not repeat their contents.
Expected<display::Head> parse_head(std::string_view packet);

}  // namespace tessera::tools
