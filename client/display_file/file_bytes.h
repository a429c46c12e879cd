#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::display_file {

// The whole of a regular file. NotFound, InvalidInput (a folder, a device, more than `most` bytes) or Io,
// with the path and the remedy.
Expected<std::vector<std::byte>> read_file(const std::string& path, std::size_t most);

// No calibration file is larger.
inline constexpr std::size_t MostCalibrationBytes = std::size_t{1} << 30;

}  // namespace tessera::display_file
