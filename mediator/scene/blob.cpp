#include "mediator/scene/blob.h"

namespace tessera::scene {

Blob::Blob(std::span<const std::byte> data)
    : storage_(data.begin(), data.end()), byte_size_(data.size()), hash_(blake2b(data)) {
    storage_.resize(byte_size_ + Padding);
}

Blob::Blob(std::vector<std::byte> data, const Hash256& hash)
    : storage_(std::move(data)), byte_size_(storage_.size()), hash_(hash) {
    storage_.resize(byte_size_ + Padding);
}

BlobPtr BlobStore::insert(BlobPtr blob) {
    const std::scoped_lock lock(mutex_);
    const auto [it, inserted] = blobs_.try_emplace(blob->hash(), Entry{blob, mark_});
    if (inserted) byte_size_ += blob->bytes().size();
    it->second.used = mark_;
    return it->second.blob;
}

BlobPtr BlobStore::insert(std::span<const std::byte> data) {
    return insert(std::make_shared<const Blob>(data));
}

BlobPtr BlobStore::find(const Hash256& hash) const {
    const std::scoped_lock lock(mutex_);
    const auto it = blobs_.find(hash);
    if (it == blobs_.end()) return nullptr;
    it->second.used = mark_;
    return it->second.blob;
}

std::size_t BlobStore::erase_unused() {
    const std::scoped_lock lock(mutex_);
    std::size_t freed = 0;
    std::erase_if(blobs_, [&](const auto& entry) {
        if (entry.second.blob.use_count() > 1) return false;
        freed += entry.second.blob->bytes().size();
        return true;
    });
    byte_size_ -= freed;
    return freed;
}

std::uint64_t BlobStore::mark() {
    const std::scoped_lock lock(mutex_);
    return ++mark_;
}

std::vector<BlobRef> BlobStore::erase_unused(const std::set<Hash256>& keep, std::uint64_t mark) {
    constexpr std::size_t Slice = 256;  // others wait meanwhile
    std::vector<BlobRef> freed;
    std::vector<BlobPtr> garbage;  // freed without the lock: unmapping gigabytes takes long
    Hash256 next{};
    for (bool is_done = false; !is_done;) {
        {
            const std::scoped_lock lock(mutex_);
            auto entry = blobs_.lower_bound(next);
            for (std::size_t i = 0; i < Slice && entry != blobs_.end(); ++i) {
                const bool is_unused = entry->second.used < mark && entry->second.blob.use_count() == 1 &&
                                       !keep.contains(entry->first);
                if (!is_unused) {
                    ++entry;
                    continue;
                }
                freed.push_back(reference(*entry->second.blob));
                byte_size_ -= freed.back().byte_size;
                garbage.push_back(std::move(entry->second.blob));
                entry = blobs_.erase(entry);
            }
            is_done = entry == blobs_.end();
            if (!is_done) next = entry->first;
        }
        garbage.clear();
    }
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
