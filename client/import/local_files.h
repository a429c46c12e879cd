#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::import {

// Reads a regular file of at most MaxFileBytes. NotFound, InvalidInput (a folder, a device, too big) or Io.
Expected<std::vector<unsigned char>> read_whole_file(const std::filesystem::path& path);

// Restricts a scene file to files in its folder and below, by relative path. Scene files are untrusted, so
// absolute paths, "..", other URL schemes and links out of the folder are rejected.
class LocalFolder {
  public:
    explicit LocalFolder(const std::filesystem::path& scene_file);

    // `name` is percent-decoded and uses slashes. NotFound or InvalidInput, naming the file.
    Expected<std::filesystem::path> locate(std::string_view name) const;
    Expected<std::vector<unsigned char>> read(std::string_view name) const;

  private:
    std::filesystem::path folder_;  // canonical
};

}  // namespace tessera::import
