#pragma once

#include <assimp/IOSystem.hpp>
#include <filesystem>
#include <memory>

#include "client/import/local_files.h"

namespace tessera::import {

// Restricts assimp to the scene file and the files in its folder. Files are read completely when opened.
class AssimpFiles final : public Assimp::IOSystem {
  public:
    explicit AssimpFiles(const std::filesystem::path& scene_file)
        : scene_file_(scene_file), folder_(scene_file) {}

    bool Exists(const char* name) const override;
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* name, const char* mode) override;
    void Close(Assimp::IOStream* stream) override;

  private:
    Expected<std::vector<unsigned char>> read(const char* name) const;

    std::filesystem::path scene_file_;
    LocalFolder folder_;
};

}  // namespace tessera::import
