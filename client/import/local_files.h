#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::import {

// The whole of a regular file of at most MaxFileBytes. NotFound, InvalidInput (a folder, a device, too big)
// or Io.
Expected<std::vector<unsigned char>> read_whole_file(const std::filesystem::path& path);

// What a scene file may reach: files in its own folder and below, by relative names. A scene comes from
// anywhere, so absolute names, "..", other schemes and links that lead out are refused.
class LocalFolder {
  public:
    explicit LocalFolder(const std::filesystem::path& scene_file);

    // `name` is decoded (no %20) and uses slashes. NotFound or InvalidInput, naming it.
    Expected<std::filesystem::path> locate(std::string_view name) const;
    Expected<std::vector<unsigned char>> read(std::string_view name) const;

  private:
    std::filesystem::path folder_;  // canonical
};

}  // namespace tessera::import
