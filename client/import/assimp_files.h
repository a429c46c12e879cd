#pragma once

#include <assimp/IOSystem.hpp>
#include <filesystem>
#include <memory>

#include "client/import/local_files.h"

namespace tessera::import {

// All that assimp may open: the scene's file and what lies in its folder. Whole files are read at once.
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
