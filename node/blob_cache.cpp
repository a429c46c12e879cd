#include "node/blob_cache.h"

#include <unistd.h>

#include <fstream>
#include <vector>

#include "mediator/base/disk_cache.h"
#include "mediator/base/error.h"

namespace tessera::node {

namespace {

namespace fs = std::filesystem;

bool is_cache_file(const fs::path& path) {
    const std::string name = path.filename().string();
    return name.size() == 64 && name.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

BlobCache::BlobCache(fs::path folder, std::uint64_t byte_limit)
    : folder_(std::move(folder)), byte_limit_(byte_limit) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) {
        throw Error(ErrorCode::Io, "cannot make the cache folder '" + folder_.string() +
                                       "': " + error.message() + "; choose another with --cache");
    }
    shrink();
}

scene::BlobPtr BlobCache::load(const scene::BlobRef& blob) {
    const fs::path path = folder_ / to_hex(blob.hash);
    std::error_code error;
    const std::uint64_t size = fs::file_size(path, error);
    if (error) return nullptr;
    if (size == blob.byte_size) {
        std::vector<std::byte> data(size);
        std::ifstream file(path, std::ios::binary);
        file.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(size));
        if (file && blake2b(data) == blob.hash) {
            fs::last_write_time(path, fs::file_time_type::clock::now(), error);  // used just now
            return std::make_shared<const scene::Blob>(std::move(data), blob.hash);
        }
    }
    fs::remove(path, error);
    return nullptr;
}

void BlobCache::save(const scene::Blob& blob) {
    if (blob.bytes().size() > byte_limit_) return;
    const fs::path path = folder_ / to_hex(blob.hash());
    const fs::path unfinished = folder_ / (to_hex(blob.hash()) + "." + std::to_string(::getpid()) + ".part");
    std::error_code error;
    if (fs::exists(path, error)) return;
    {
        std::ofstream file(unfinished, std::ios::binary);
        file.write(reinterpret_cast<const char*>(blob.bytes().data()),
                   static_cast<std::streamsize>(blob.bytes().size()));
        if (!file.flush()) {
            file.close();
            fs::remove(unfinished, error);
            return;
        }
    }
    fs::rename(unfinished, path, error);
    byte_size_ += blob.bytes().size();
    if (byte_size_ > byte_limit_) shrink();
}

void BlobCache::shrink() {
    byte_size_ = shrink_folder(folder_, byte_limit_, is_cache_file);
}

}  // namespace tessera::node
