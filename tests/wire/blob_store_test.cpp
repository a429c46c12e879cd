#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "mediator/scene/blob.h"
#include "mediator/wire/blob_transfer.h"

namespace tessera::wire {
namespace {

std::vector<std::byte> bytes(std::size_t size, int value) {
    return std::vector<std::byte>(size, std::byte(value));
}

TEST(BlobStoreTest, ACollectorFreesWhatNothingUsed) {
    scene::BlobStore store;
    const Hash256 unused = store.insert(bytes(10, 1))->hash(), kept = store.insert(bytes(20, 2))->hash();
    const scene::BlobPtr held = store.insert(bytes(30, 3));
    const Hash256 found = store.insert(bytes(40, 4))->hash();
    const std::uint64_t mark = store.mark();
    (void)store.find(found);
    const Hash256 late = store.insert(bytes(50, 5))->hash();
    const auto freed = store.erase_unused({kept}, mark);
    ASSERT_EQ(freed.size(), 1u);
    EXPECT_EQ(freed[0].hash, unused);
    EXPECT_EQ(freed[0].byte_size, 10u);
    EXPECT_EQ(store.byte_size(), 140u);
    for (const Hash256& hash : {kept, held->hash(), found, late}) EXPECT_NE(store.find(hash), nullptr);
    EXPECT_EQ(store.find(unused), nullptr);
}

TEST(BlobStoreTest, ThousandsOfBlobsAreFreedInSlices) {
    scene::BlobStore store;
    for (int i = 0; i < 2000; ++i) {
        std::vector<std::byte> data(8);
        std::memcpy(data.data(), &i, sizeof i);
        (void)store.insert(data);
    }
    EXPECT_EQ(store.erase_unused({}, store.mark()).size(), 2000u);
    EXPECT_EQ(store.count(), 0u);
    EXPECT_EQ(store.byte_size(), 0u);
}

// Blobs that have arrived wait for the edit that refers to them, and count until they are complete.
TEST(BlobFetcherTest, HoldsCompletedBlobsAndGivesTheirBytesBack) {
    const auto store = std::make_shared<scene::BlobStore>();
    BlobFetcher fetcher(store, {.bytes_per_blob = 1000, .bytes_total = 1000});
    const std::vector<std::byte> data = bytes(800, 7), other = bytes(900, 8);
    const Hash256 hash = blake2b(data);
    ASSERT_TRUE(fetcher.want({hash, 800}));
    EXPECT_FALSE(fetcher.want({blake2b(other), 900})) << "more than may be under way";
    ASSERT_TRUE(fetcher.receive({hash, 800, 0, {data.begin(), data.begin() + 500}}, {}));
    EXPECT_EQ(fetcher.wanted_bytes(), 800u);
    ASSERT_TRUE(fetcher.receive({hash, 800, 500, {data.begin() + 500, data.end()}}, {}));
    EXPECT_EQ(fetcher.wanted_bytes(), 0u);
    EXPECT_TRUE(fetcher.want({blake2b(other), 900}));
    EXPECT_TRUE(store->erase_unused({}, store->mark()).empty()) << "the edit is not here yet";
    fetcher.release_completed();
    EXPECT_EQ(store->erase_unused({}, store->mark()).size(), 1u);
}

// Each byte crosses the network once, in small chunks, of which a limited number is under way.
TEST(BlobFetcherTest, FetchesALargeBlobInSmallChunks) {
    scene::BlobStore sender;
    const auto store = std::make_shared<scene::BlobStore>();
    const std::size_t size = 40 * BlobChunkBytes + 5;
    const scene::BlobPtr blob = sender.insert(bytes(size, 7));
    BlobFetcher fetcher(store, {});
    const Hash256 hash = blake2b(blob->bytes());
    ASSERT_TRUE(fetcher.want({hash, size}));
    std::size_t chunks = 0;
    while (!fetcher.idle()) {
        const std::vector<BlobRequest> requests = fetcher.due({});
        ASSERT_FALSE(requests.empty());
        EXPECT_LE(requests.size(), 32u);
        for (const BlobRequest& request : requests) {
            auto answered = answer(request, sender);
            auto& chunk = std::get<BlobChunk>(answered);
            EXPECT_LE(chunk.data.size(), std::size_t{256} << 10) << "a long step of the master's event loop";
            ASSERT_TRUE(fetcher.receive(std::move(chunk), {}));
            ++chunks;
        }
    }
    EXPECT_EQ(chunks, 41u);
    EXPECT_EQ(fetcher.received_bytes(), size);
    EXPECT_NE(store->find(hash), nullptr);
}

TEST(BlobFetcherTest, AWrongHashStartsAgain) {
    const auto store = std::make_shared<scene::BlobStore>();
    BlobFetcher fetcher(store, {});
    const std::vector<std::byte> data = bytes(10, 7), wrong = bytes(10, 8);
    const Hash256 hash = blake2b(data);
    ASSERT_TRUE(fetcher.want({hash, 10}));
    EXPECT_FALSE(fetcher.receive({hash, 10, 0, wrong}, {}));
    EXPECT_EQ(fetcher.due({}).size(), 1u) << "it is requested again";
    EXPECT_TRUE(fetcher.receive({hash, 10, 0, data}, {}));
    EXPECT_NE(store->find(hash), nullptr);
}

}  // namespace
}  // namespace tessera::wire
