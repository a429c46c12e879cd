#include "node/blob_cache.h"

#include "mediator/base/disk_cache.h"
#include "mediator/base/error.h"
#include "mediator/scene/blob_file.h"

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
        throw Error(ErrorCode::Io, "cannot create the cache folder '" + folder_.string() +
                                       "': " + error.message() + "; choose another with --cache");
    }
    shrink();
}

scene::BlobPtr BlobCache::load(const scene::BlobRef& blob) {
    std::error_code error;
    if (scene::BlobPtr found = scene::read_blob(folder_, blob)) {
        fs::last_write_time(scene::blob_path(folder_, blob), fs::file_time_type::clock::now(),
                            error);  // used just now
        return found;
    }
    fs::remove(scene::blob_path(folder_, blob), error);
    return nullptr;
}

void BlobCache::save(const scene::Blob& blob) {
    if (blob.bytes().size() > byte_limit_) return;
    std::error_code error;
    if (fs::exists(scene::blob_path(folder_, reference(blob)), error)) return;
    if (!scene::write_blob(folder_, blob)) return;
    byte_size_ += blob.bytes().size();
    if (byte_size_ > byte_limit_) shrink();
}

void BlobCache::shrink() {
    byte_size_ = shrink_folder(folder_, byte_limit_, is_cache_file);
}

}  // namespace tessera::node
