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

// Removes the least recently written of the files that are `ours` until the others hold at most `byte_limit`.
// Returns what these hold.
std::uint64_t shrink_folder(const std::filesystem::path& folder, std::uint64_t byte_limit,
                            const std::function<bool(const std::filesystem::path&)>& ours);

// What took long to make and can be made again, kept on disk under a hash of all that it was made from. A
// file is written under another name first, and verified when it is read: what is damaged is removed, told
// and not given. The least recently used go first when there is too much. A cache that cannot be written is a
// smaller cache, never an error. Several caches of other kinds, and several processes, may share the folder.
// Thread-safe.
class DiskCache final {
  public:
    // `kind` is the files' extension, a few lower-case letters. An empty folder: nothing is ever kept.
    DiskCache(std::filesystem::path folder, std::string kind, std::uint64_t byte_limit);

    std::optional<std::vector<std::byte>> load(const Hash256& key);
    void save(const Hash256& key, std::span<const std::byte> data);

    // What went wrong since the last call, a phrase each.
    std::vector<std::string> take_notes();

  private:
    std::filesystem::path path_of(const Hash256& key) const;
    void note(const std::string& text);
    void shrink();

    const std::filesystem::path folder_;
    const std::string kind_;
    const std::uint64_t byte_limit_;

    std::mutex mutex_;             // protects all below, and files from being removed while they are read
    std::uint64_t byte_size_ = 0;  // as far as we know; shrink() counts anew
    std::vector<std::string> notes_;
};

}  // namespace tessera
