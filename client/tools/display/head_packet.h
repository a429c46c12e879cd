#pragma once

#include <string_view>

#include "mediator/base/error.h"
#include "mediator/display/display.h"

namespace tessera::tools {

inline constexpr std::size_t MaxHeadPacket = 512;  // bytes

// What a tracker says in one UDP packet: a line "x y z" or "x y z qw qx qy qz", the word "head" before it or
// not. Metres in display space; a quaternion of any length but zero, made unit; without one the head looks
// along -z. Anyone may have sent it: a failure says what is wrong without repeating a byte of it.
Expected<display::Head> parse_head(std::string_view packet);

}  // namespace tessera::tools
