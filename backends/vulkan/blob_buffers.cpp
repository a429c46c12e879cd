#include "backends/vulkan/blob_buffers.h"

#include <algorithm>

#include "backends/vulkan/device/transfer.h"

namespace tessera::vulkan {

std::uint64_t BlobBuffers::address_of(const scene::BlobPtr& blob) {
    auto it = entries_.find(blob->hash());
    if (it == entries_.end()) {
        const std::span<const std::byte> bytes = blob->bytes();
        Buffer buffer(device_, std::max<std::size_t>(bytes.size(), 16));
        upload_bytes(device_, buffer, bytes);
        it = entries_.emplace(blob->hash(), Entry{std::move(buffer)}).first;
    }
    it->second.used = true;
    return it->second.buffer.address();
}

void BlobBuffers::drop_unused() {
    std::erase_if(entries_, [](const auto& entry) { return !entry.second.used; });
    for (auto& [hash, entry] : entries_) entry.used = false;
}

}  // namespace tessera::vulkan
