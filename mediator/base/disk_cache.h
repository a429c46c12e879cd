#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mediator/base/hash.h"

namespace tessera {

// Removes the least recently written of the files for which `ours` is true until the others have at most `byte_limit`
// bytes. Returns the size of these.
std::uint64_t shrink_folder(const std::filesystem::path& folder, std::uint64_t byte_limit,
                            const std::function<bool(const std::filesystem::path&)>& ours);

// A disk cache of derived data, under a hash of everything it was computed from. Files are written under a temporary
// name and renamed, and verified when read; damaged ones are reported and removed. The least recently used are evicted.
// Write failures only make the cache smaller. Several caches of other kinds, and several processes, may share the
// folder. Thread-safe.
class DiskCache final {
  public:
    // `kind` is the files' extension, a few lower-case letters. An empty folder name: nothing is cached.
    DiskCache(std::filesystem::path folder, std::string kind, std::uint64_t byte_limit);

    std::optional<std::vector<std::byte>> load(const Hash256& key);
    void save(const Hash256& key, std::span<const std::byte> data);

    // Errors since the last call, one phrase each.
    std::vector<std::string> take_notes();

  private:
    std::filesystem::path path_of(const Hash256& key) const;
    void note(const std::string& text);
    void shrink();

    const std::filesystem::path folder_;
    const std::string kind_;
    const std::uint64_t byte_limit_;

    std::mutex mutex_;             // protects all below, and files from being removed while they are read
    std::uint64_t byte_size_ = 0;  // estimate; shrink() recounts
    std::vector<std::string> notes_;
};

}  // namespace tessera
