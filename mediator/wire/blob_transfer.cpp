#include "mediator/wire/blob_transfer.h"

#include <algorithm>

namespace tessera::wire {

Expected<void> BlobFetcher::want(const scene::BlobRef& blob) {
    if (blob.empty() || store_->find(blob.hash)) return {};
    if (const auto known = partial_.find(blob.hash); known != partial_.end()) {
        Partial& partial = known->second;
        if (partial.absent) partial.requested = partial.data.size();  // the peer may have it now
        partial.absent = false;
        return {};
    }
    if (blob.byte_size > limits_.bytes_per_blob) {
        return failure(ErrorCode::Refused,
                       "blob " + to_hex(blob.hash).substr(0, 12) + " has " + std::to_string(blob.byte_size) +
                           " bytes, more than the limit of " + std::to_string(limits_.bytes_per_blob));
    }
    if (wanted_bytes_ + blob.byte_size > limits_.bytes_total) {
        return failure(ErrorCode::Refused, "the blobs under way exceed the quota of " +
                                               std::to_string(limits_.bytes_total) +
                                               " bytes: raise --blob-quota");
    }
    wanted_bytes_ += blob.byte_size;
    partial_[blob.hash].total = blob.byte_size;
    return {};
}

std::vector<BlobRequest> BlobFetcher::due(TimePoint now) {
    std::vector<BlobRequest> requests;
    std::uint32_t in_flight = 0;
    for (auto& [hash, partial] : partial_) {
        // No answer: request again from the end of the received data.
        if (partial.requested > partial.data.size() && now - partial.last_activity > limits_.retry_after) {
            partial.requested = partial.data.size();
        }
        in_flight += static_cast<std::uint32_t>(
            (partial.requested - std::min<std::uint64_t>(partial.requested, partial.data.size()) +
             BlobChunkBytes - 1) /
            BlobChunkBytes);
    }
    for (auto& [hash, partial] : partial_) {
        if (partial.absent) continue;
        for (; partial.requested < partial.total && in_flight < limits_.requests_in_flight; ++in_flight) {
            requests.push_back({hash, partial.requested});
            partial.requested = std::min(partial.total, partial.requested + BlobChunkBytes);
            partial.last_activity = now;
        }
    }
    return requests;
}

Expected<void> BlobFetcher::receive(BlobChunk&& chunk, TimePoint now) {
    const auto it = partial_.find(chunk.hash);
    if (it == partial_.end()) {
        if (store_->find(chunk.hash)) return {};  // a late duplicate
        return failure(ErrorCode::InvalidInput, "an unrequested blob");
    }
    Partial& partial = it->second;
    if (chunk.total != partial.total || chunk.offset + chunk.data.size() > partial.total) {
        return failure(ErrorCode::InvalidInput, "a blob of another size than announced");
    }
    partial.last_activity = now;
    // In order only: chunks that arrive early are requested again, duplicates are ignored.
    if (chunk.offset != partial.data.size()) {
        if (chunk.offset > partial.data.size()) partial.requested = partial.data.size();
        return {};
    }
    received_bytes_ += chunk.data.size();
    if (partial.data.empty()) {
        partial.data.reserve(partial.total + scene::Blob::Padding);
        partial.hash = std::make_unique<Blake2b>();
    }
    partial.hash->update(chunk.data);
    partial.data.insert(partial.data.end(), chunk.data.begin(), chunk.data.end());
    partial.requested = std::max<std::uint64_t>(partial.requested, partial.data.size());
    if (partial.data.size() < partial.total) return {};
    if (partial.hash->finish() != chunk.hash) {
        partial.data = {};
        partial.requested = 0;
        return failure(ErrorCode::InvalidInput,
                       "blob " + to_hex(chunk.hash).substr(0, 12) + " has the wrong hash");
    }
    completed_.push_back(
        store_->insert(std::make_shared<const scene::Blob>(std::move(partial.data), chunk.hash)));
    wanted_bytes_ -= partial.total;
    partial_.erase(it);
    return {};
}

void BlobFetcher::absent(const Hash256& hash) {
    const auto it = partial_.find(hash);
    if (it == partial_.end()) return;
    it->second.absent = true;
    it->second.requested = it->second.data.size();  // others may be requested instead
}

void BlobFetcher::forget(const Hash256& hash) {
    const auto it = partial_.find(hash);
    if (it == partial_.end()) return;
    wanted_bytes_ -= it->second.total;
    partial_.erase(it);
}

void BlobFetcher::forget_all() {
    for (const auto& [hash, partial] : partial_) wanted_bytes_ -= partial.total;
    partial_.clear();
}

std::vector<Hash256> BlobFetcher::absent_blobs() const {
    std::vector<Hash256> hashes;
    for (const auto& [hash, partial] : partial_) {
        if (partial.absent) hashes.push_back(hash);
    }
    return hashes;
}

BulkMessage answer(const BlobRequest& request, const scene::BlobStore& store) {
    const scene::BlobPtr blob = store.find(request.hash);
    if (!blob || request.offset > blob->bytes().size()) return BlobAbsent{request.hash};
    const auto range = blob->bytes().subspan(request.offset);
    const auto data = range.first(std::min<std::size_t>(range.size(), BlobChunkBytes));
    return BlobChunk{request.hash, blob->bytes().size(), request.offset, {data.begin(), data.end()}};
}

}  // namespace tessera::wire
