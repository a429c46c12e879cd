#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/error.h"
#include "mediator/scene/blob.h"
#include "mediator/wire/messages.h"

// Blobs are pulled: the receiver requests a byte range, the sender answers with a chunk, so an interrupted
// transfer can resume. Pure state, no sockets.
namespace tessera::wire {

// Small, because the event loop of the master serves nothing else while it hashes and stores one: fresh memory may cost
// three times the time of the hash.
inline constexpr std::uint64_t BlobChunkBytes = std::uint64_t{256} << 10;

struct BlobLimits {
    std::uint64_t bytes_per_blob = 4ull << 30;
    std::uint64_t bytes_total = 16ull << 30;  // under way from a peer at a time; held for a key
    std::uint32_t requests_in_flight = 32;    // requested chunks that have not arrived
    Duration retry_after = std::chrono::seconds(3);
};

// The receiving side.
class BlobFetcher {
  public:
    BlobFetcher(std::shared_ptr<scene::BlobStore> store, BlobLimits limits)
        : store_(std::move(store)), limits_(limits) {}

    // Fails when over a limit; does nothing for a blob that is in the store. One that was absent is requested again.
    Expected<void> want(const scene::BlobRef& blob);
    std::vector<BlobRequest> due(
        TimePoint now);  // requests to send now: next ranges, and those without an answer
    // Puts a complete, verified blob into the store. InvalidInput: not requested, beyond the size, or a wrong hash (the
    // received data is dropped and requested again).
    Expected<void> receive(BlobChunk&& chunk, TimePoint now);
    void absent(const Hash256& hash);  // the peer does not have it
    void forget(const Hash256& hash);  // it is not wanted any more
    void forget_all();
    // Completed blobs are held until then: no edit refers to them yet.
    void release_completed() { completed_.clear(); }
    bool wants(const Hash256& hash) const { return partial_.contains(hash); }
    bool idle() const { return partial_.empty(); }
    std::vector<Hash256> absent_blobs() const;
    std::uint64_t received_bytes() const { return received_bytes_; }
    std::uint64_t wanted_bytes() const { return wanted_bytes_; }  // of those that are not complete

  private:
    struct Partial {
        std::uint64_t total = 0;
        // Reserved whole at the first chunk, which touches no memory: it is never copied, and only what has arrived is
        // resident.
        std::vector<std::byte> data;
        std::unique_ptr<Blake2b> hash;  // of the data: as it arrives, since gigabytes take seconds
        std::uint64_t requested = 0;    // end of the requested range
        TimePoint last_activity{};
        bool absent = false;
    };
    std::shared_ptr<scene::BlobStore> store_;
    BlobLimits limits_;
    std::map<Hash256, Partial> partial_;
    std::vector<scene::BlobPtr> completed_;
    std::uint64_t wanted_bytes_ = 0, received_bytes_ = 0;
};

// The sending side: BlobChunk for a range that exists, else BlobAbsent.
BulkMessage answer(const BlobRequest& request, const scene::BlobStore& store);

}  // namespace tessera::wire
