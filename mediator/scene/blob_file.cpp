#include "mediator/scene/blob_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

namespace tessera::scene {

namespace fs = std::filesystem;

fs::path blob_path(const fs::path& folder, const BlobRef& blob) {
    return folder / to_hex(blob.hash);
}

BlobPtr read_blob(const fs::path& folder, const BlobRef& blob) {
    const fs::path path = blob_path(folder, blob);
    std::error_code error;
    if (fs::file_size(path, error) != blob.byte_size || error) return nullptr;
    std::vector<std::byte> data(blob.byte_size);
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(data.size()));
    if (!file || blake2b(data) != blob.hash) return nullptr;
    return std::make_shared<const Blob>(std::move(data), blob.hash);
}

namespace {

bool sync(const fs::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    const bool is_synced = ::fsync(file) == 0;
    const int reason = errno;
    ::close(file);
    errno = reason;
    return is_synced;
}

Expected<void> write(const fs::path& folder, const Blob& blob, const std::string& suffix, bool syncs) {
    const fs::path path = blob_path(folder, reference(blob));
    const fs::path unfinished = path.string() + suffix;
    std::error_code error;
    {
        std::ofstream file(unfinished, std::ios::binary);
        file.write(reinterpret_cast<const char*>(blob.bytes().data()),
                   static_cast<std::streamsize>(blob.bytes().size()));
        if (!file.flush() || (syncs && !sync(unfinished))) {
            const std::string reason = std::strerror(errno);
            file.close();
            fs::remove(unfinished, error);
            return failure(ErrorCode::Io, "cannot write '" + path.string() + "': " + reason +
                                              "; check the folder, its rights and the free space");
        }
    }
    fs::rename(unfinished, path, error);
    if (!error && (!syncs || sync(folder))) return {};
    return failure(ErrorCode::Io, "cannot write '" + path.string() +
                                      "': " + (error ? error.message() : std::strerror(errno)));
}

}  // namespace

Expected<void> write_blob(const fs::path& folder, const Blob& blob) {
    // What a loss of power left of it is written again.
    if (read_blob(folder, reference(blob))) return {};
    return write(folder, blob, "." + std::to_string(::getpid()) + ".part", false);
}

Expected<void> replace_blob(const fs::path& folder, const Blob& blob) {
    return write(folder, blob, "." + std::to_string(::getpid()) + ".again.part", true);
}

}  // namespace tessera::scene
