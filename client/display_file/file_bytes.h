#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::display_file {

// Reads a regular file. Errors: NotFound, InvalidInput (a folder, a device, more than `most` bytes) or Io, with the
// path and the remedy.
Expected<std::vector<std::byte>> read_file(const std::string& path, std::size_t most);

// Upper limit for calibration files.
inline constexpr std::size_t MostCalibrationBytes = std::size_t{1} << 30;

}  // namespace tessera::display_file
