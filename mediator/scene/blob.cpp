#include "mediator/scene/blob.h"

namespace tessera::scene {

namespace {
constexpr std::size_t ReadablePadding = 16;
}

Blob::Blob(std::span<const std::byte> data)
    : storage_(data.begin(), data.end()), byte_size_(data.size()), hash_(blake2b(data)) {
    storage_.resize(byte_size_ + ReadablePadding);
}

Blob::Blob(std::vector<std::byte> data, const Hash256& hash)
    : storage_(std::move(data)), byte_size_(storage_.size()), hash_(hash) {
    storage_.resize(byte_size_ + ReadablePadding);
}

BlobPtr BlobStore::insert(BlobPtr blob) {
    const std::scoped_lock lock(mutex_);
    const auto [it, inserted] = blobs_.try_emplace(blob->hash(), blob);
    if (inserted) byte_size_ += blob->bytes().size();
    return it->second;
}

BlobPtr BlobStore::insert(std::span<const std::byte> data) {
    return insert(std::make_shared<const Blob>(data));
}

BlobPtr BlobStore::find(const Hash256& hash) const {
    const std::scoped_lock lock(mutex_);
    const auto it = blobs_.find(hash);
    return it == blobs_.end() ? nullptr : it->second;
}

std::size_t BlobStore::erase_unused() {
    const std::scoped_lock lock(mutex_);
    std::size_t freed = 0;
    std::erase_if(blobs_, [&](const auto& entry) {
        if (entry.second.use_count() > 1) return false;
        freed += entry.second->bytes().size();
        return true;
    });
    byte_size_ -= freed;
    return freed;
}

std::size_t BlobStore::byte_size() const {
    const std::scoped_lock lock(mutex_);
    return byte_size_;
}

std::size_t BlobStore::count() const {
    const std::scoped_lock lock(mutex_);
    return blobs_.size();
}

}  // namespace tessera::scene
