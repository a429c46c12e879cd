#include "mediator/base/disk_cache.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <functional>
#include <utility>

namespace tessera {

namespace {

namespace fs = std::filesystem;

// Before the data of every file.
struct Header {
    std::array<char, 8> magic{};
    std::uint64_t size = 0;  // of the data
    Hash256 key, checksum;   // the checksum is of the data
};
static_assert(sizeof(Header) == 80, "the header must not have padding");

constexpr std::array<char, 8> Magic{'t', 'e', 's', 's', 'c', 'a', 'c', '1'};

std::optional<std::vector<std::byte>> read_verified(const fs::path& path, const Hash256& key) {
    std::error_code error;
    const std::uint64_t size = fs::file_size(path, error);
    Header header;
    if (error || size < sizeof header) return std::nullopt;
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(&header), sizeof header);
    const bool fits =
        file && header.magic == Magic && header.key == key && header.size == size - sizeof header;
    if (!fits) return std::nullopt;
    std::vector<std::byte> data(header.size);
    file.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(data.size()));
    if (!file || blake2b(data) != header.checksum) return std::nullopt;
    return data;
}

}  // namespace

std::uint64_t shrink_folder(const fs::path& folder, std::uint64_t byte_limit,
                            const std::function<bool(const fs::path&)>& ours) {
    struct File {
        fs::file_time_type used;
        std::uint64_t size;
        fs::path path;
    };
    std::vector<File> files;
    std::uint64_t byte_size = 0;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        if (!ours(entry.path())) continue;
        std::error_code gone;  // another process may have removed it
        const File file{entry.last_write_time(gone), entry.file_size(gone), entry.path()};
        if (gone) continue;
        files.push_back(file);
        byte_size += file.size;
    }
    std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.used < b.used; });
    for (const File& file : files) {
        if (byte_size <= byte_limit) break;
        if (fs::remove(file.path, error)) byte_size -= file.size;
    }
    return byte_size;
}

DiskCache::DiskCache(fs::path folder, std::string kind, std::uint64_t byte_limit)
    : folder_(std::move(folder)), kind_(std::move(kind)), byte_limit_(byte_limit) {
    if (folder_.empty()) return;
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) note("cannot create the cache folder '" + folder_.string() + "': " + error.message());
    shrink();
}

fs::path DiskCache::path_of(const Hash256& key) const {
    return folder_ / (to_hex(key) + "." + kind_);
}

void DiskCache::note(const std::string& text) {
    if (std::find(notes_.begin(), notes_.end(), text) == notes_.end()) notes_.push_back(text);
}

std::optional<std::vector<std::byte>> DiskCache::load(const Hash256& key) {
    if (folder_.empty()) return std::nullopt;
    const fs::path path = path_of(key);
    const std::scoped_lock lock(mutex_);
    std::error_code error;
    if (!fs::exists(path, error)) return std::nullopt;
    auto data = read_verified(path, key);
    if (data) {
        fs::last_write_time(path, fs::file_time_type::clock::now(), error);  // used just now
    } else {
        fs::remove(path, error);
        note("the cache file '" + path.string() + "' is damaged; it is rebuilt");
    }
    return data;
}

void DiskCache::save(const Hash256& key, std::span<const std::byte> data) {
    const std::uint64_t size = sizeof(Header) + data.size();
    if (folder_.empty() || size > byte_limit_) return;
    const fs::path path = path_of(key);
    const fs::path unfinished = path.string() + "." + std::to_string(::getpid()) + ".part";
    const Header header{Magic, data.size(), key, blake2b(data)};
    const std::scoped_lock lock(mutex_);
    std::error_code error;
    {
        std::ofstream file(unfinished, std::ios::binary);
        file.write(reinterpret_cast<const char*>(&header), sizeof header);
        file.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
        if (!file.flush()) {
            note("cannot write into the cache folder '" + folder_.string() +
                 "'; check its rights and the free space");
            file.close();
            fs::remove(unfinished, error);
            return;
        }
    }
    fs::rename(unfinished, path, error);
    byte_size_ += size;
    if (byte_size_ > byte_limit_) shrink();
}

void DiskCache::shrink() {
    byte_size_ = shrink_folder(folder_, byte_limit_,
                               [&](const fs::path& path) { return path.extension() == "." + kind_; });
}

std::vector<std::string> DiskCache::take_notes() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(notes_, {});
}

}  // namespace tessera
