#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/error.h"
#include "mediator/scene/blob.h"
#include "mediator/wire/messages.h"

// Blobs go by want: whoever lacks one asks for a byte range, whoever has it answers with chunks of 1 MiB, so
// a transfer resumes where it broke off. Pure state, no sockets.
namespace tessera::wire {

struct BlobLimits {
    std::uint64_t bytes_per_blob = 4ull << 30;
    std::uint64_t bytes_total = 16ull << 30;  // quota of one peer's wants
    std::uint32_t requests_in_flight = 8;     // chunks asked for and not yet here
    Duration retry_after = std::chrono::seconds(3);
};

// The receiving side.
class BlobFetcher {
  public:
    BlobFetcher(std::shared_ptr<scene::BlobStore> store, BlobLimits limits)
        : store_(std::move(store)), limits_(limits) {}

    // Refused when over a limit; a blob that is in the store already is not wanted. One that was absent is
    // asked for again.
    Expected<void> want(const scene::BlobRef& blob);
    std::vector<BlobRequest> due(TimePoint now);  // to send now: next ranges, and those that got no answer
    // A verified whole blob goes into the store. InvalidInput: not asked for, beyond the size, or the wrong
    // hash (what was received is dropped and asked for again).
    Expected<void> receive(BlobChunk&& chunk, TimePoint now);
    void absent(const Hash256& hash);  // the peer does not have it
    void forget_all();
    bool idle() const { return partial_.empty(); }
    std::vector<Hash256> absent_blobs() const;
    std::uint64_t received_bytes() const { return received_bytes_; }

  private:
    struct Partial {
        std::uint64_t total = 0;
        std::vector<std::byte> data;  // grows with what came, never ahead of it
        std::uint64_t requested = 0;  // end of what was asked for
        TimePoint last_activity{};
        bool absent = false;
    };
    std::shared_ptr<scene::BlobStore> store_;
    BlobLimits limits_;
    std::map<Hash256, Partial> partial_;
    std::uint64_t wanted_bytes_ = 0, received_bytes_ = 0;
};

// The giving side: BlobChunk for a range that exists, else BlobAbsent.
BulkMessage answer(const BlobRequest& request, const scene::BlobStore& store);

}  // namespace tessera::wire
