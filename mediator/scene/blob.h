#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <vector>

#include "mediator/base/hash.h"

namespace tessera::scene {

// Immutable bytes addressed by their BLAKE2b-256; shared by reference, never copied inside a process.
// The data is followed by 16 readable zero bytes (Embree reads past the last vertex).
class Blob {
  public:
    static constexpr std::size_t Padding = 16;
    explicit Blob(std::span<const std::byte> data);          // copies once and hashes
    Blob(std::vector<std::byte> data, const Hash256& hash);  // moves; the caller has verified the hash

    const Hash256& hash() const { return hash_; }
    std::span<const std::byte> bytes() const { return {storage_.data(), byte_size_}; }
    template <class T>
    std::span<const T> as() const {  // a trailing partial element is left out
        return {reinterpret_cast<const T*>(storage_.data()), byte_size_ / sizeof(T)};
    }

  private:
    std::vector<std::byte> storage_;
    std::size_t byte_size_ = 0;
    Hash256 hash_;
};

using BlobPtr = std::shared_ptr<const Blob>;

// A reference to a blob, as scene objects hold it.
struct BlobRef {
    Hash256 hash;
    std::uint64_t byte_size = 0;

    bool empty() const { return byte_size == 0; }
    friend auto operator<=>(const BlobRef&, const BlobRef&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "hash", &BlobRef::hash), row(2, "byte_size", &BlobRef::byte_size));
    }
};

inline BlobRef reference(const Blob& blob) {
    return {blob.hash(), blob.bytes().size()};
}

// All blobs of a process, by hash. Thread-safe.
class BlobStore {
  public:
    BlobPtr insert(BlobPtr blob);  // returns the existing one, if any
    BlobPtr insert(std::span<const std::byte> data);
    BlobPtr find(const Hash256& hash) const;  // null when absent
    std::size_t erase_unused();               // drops blobs that only the store holds; returns their bytes
    // For a collector: what it finds in use after mark() it keeps; of the rest, blobs go that only the store holds and
    // that were neither inserted nor found since. Returns them.
    std::uint64_t mark();
    std::vector<BlobRef> erase_unused(const std::set<Hash256>& keep, std::uint64_t mark);
    std::size_t byte_size() const;
    std::size_t count() const;

  private:
    struct Entry {
        BlobPtr blob;
        std::uint64_t used = 0;  // the mark at the latest use
    };
    mutable std::mutex mutex_;  // protects everything below
    mutable std::map<Hash256, Entry> blobs_;
    std::uint64_t mark_ = 0;
    std::size_t byte_size_ = 0;
};

}  // namespace tessera::scene
