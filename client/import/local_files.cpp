#include "client/import/local_files.h"

#include <algorithm>
#include <fstream>

#include "client/import/limits.h"

namespace tessera::import {

namespace fs = std::filesystem;

Expected<std::vector<unsigned char>> read_whole_file(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found) {
        return failure(ErrorCode::NotFound, "there is no file '" + path.string() + "': check the name");
    }
    // Pipes and devices could block or never end.
    if (status.type() != fs::file_type::regular) {
        return failure(ErrorCode::InvalidInput, "'" + path.string() + "' is not a regular file: name a file");
    }
    const std::uintmax_t byte_size = fs::file_size(path, error);
    if (error || byte_size > MaxFileBytes) {
        return failure(ErrorCode::InvalidInput, "'" + path.string() + "' is larger than 4 GiB: split it");
    }
    std::ifstream stream(path, std::ios::binary);
    std::vector<unsigned char> bytes(byte_size);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!stream) {
        return failure(ErrorCode::Io, "'" + path.string() + "' cannot be read: check its permissions");
    }
    return bytes;
}

LocalFolder::LocalFolder(const fs::path& scene_file) {
    std::error_code error;
    folder_ = fs::canonical(fs::absolute(scene_file, error).parent_path(), error);
}

Expected<fs::path> LocalFolder::locate(std::string_view name) const {
    const std::string shown(name.substr(0, 200));
    const fs::path relative{std::string(name)};
    const bool leads_out =
        std::any_of(relative.begin(), relative.end(), [](const fs::path& part) { return part == ".."; });
    if (name.empty() || name.find('\0') != name.npos || name.find("://") != name.npos || leads_out ||
        relative.is_absolute()) {
        return failure(
            ErrorCode::InvalidInput,
            "'" + shown +
                "' is not a relative path inside the scene's folder: put the file into that folder");
    }
    std::error_code error;
    const fs::path found = fs::canonical(folder_ / relative, error);
    if (error) return failure(ErrorCode::NotFound, "there is no file '" + shown + "' in the scene's folder");
    const auto [end, unused] = std::mismatch(folder_.begin(), folder_.end(), found.begin(), found.end());
    if (end != folder_.end()) {
        return failure(
            ErrorCode::InvalidInput,
            "'" + shown + "' is a link out of the scene's folder: put the file itself into that folder");
    }
    return found;
}

Expected<std::vector<unsigned char>> LocalFolder::read(std::string_view name) const {
    const Expected<fs::path> path = locate(name);
    if (!path) return tl::unexpected<Error>(path.error());
    return read_whole_file(*path);
}

}  // namespace tessera::import
