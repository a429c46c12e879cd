#include "client/import/assimp_files.h"

#include <assimp/MemoryIOWrapper.h>

#include <algorithm>

namespace tessera::import {
namespace {

// Owns the bytes that assimp's MemoryIOStream reads.
class OwnedStream final : public Assimp::IOStream {
  public:
    explicit OwnedStream(std::vector<unsigned char> bytes)
        : bytes_(std::move(bytes)), stream_(bytes_.data(), bytes_.size()) {}

    std::size_t Read(void* to, std::size_t size, std::size_t count) override {
        return stream_.Read(to, size, count);
    }
    std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
    aiReturn Seek(std::size_t offset, aiOrigin origin) override { return stream_.Seek(offset, origin); }
    std::size_t Tell() const override { return stream_.Tell(); }
    std::size_t FileSize() const override { return stream_.FileSize(); }
    void Flush() override {}

  private:
    std::vector<unsigned char> bytes_;
    Assimp::MemoryIOStream stream_;
};

}  // namespace

Expected<std::vector<unsigned char>> AssimpFiles::read(const char* name) const {
    const std::filesystem::path path(name);
    if (path == scene_file_) return read_whole_file(path);
    // assimp prepends the scene's folder to the names in the file.
    std::string relative(name);
    const std::string folder = scene_file_.parent_path().string();
    if (!folder.empty() && relative.starts_with(folder + "/")) relative = relative.substr(folder.size() + 1);
    return folder_.read(relative);
}

bool AssimpFiles::Exists(const char* name) const {
    return read(name).has_value();
}

Assimp::IOStream* AssimpFiles::Open(const char* name, const char* mode) {
    if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos) return nullptr;
    auto bytes = read(name);
    return bytes ? new OwnedStream(std::move(*bytes)) : nullptr;  // released by Close
}

void AssimpFiles::Close(Assimp::IOStream* stream) {
    delete stream;
}

}  // namespace tessera::import
