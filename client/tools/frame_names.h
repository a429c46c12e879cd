#pragma once

#include <cstdint>
#include <optional>
#include <string>

// Names of the pictures of a sequence: out.%04d.exr is out.0012.exr for frame 12.
namespace tessera::tools {

// The name of one frame's picture. Nothing unless the pattern contains exactly one of %d or %0Nd
// (N from 1 to 9), and no other percent sign.
std::optional<std::string> frame_name(const std::string& pattern, std::uint32_t frame);

}  // namespace tessera::tools
