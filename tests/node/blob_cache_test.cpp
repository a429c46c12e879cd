#include "node/blob_cache.h"

#include <gtest/gtest.h>

#include <fstream>

#include "mediator/base/error.h"

namespace tessera::node {
namespace {

namespace fs = std::filesystem;

scene::Blob blob(char fill, std::size_t size = 1000) {
    return scene::Blob(std::as_bytes(std::span<const char>(std::vector<char>(size, fill))));
}

struct BlobCacheTest : testing::Test {
    BlobCacheTest() { fs::remove_all(folder); }
    ~BlobCacheTest() override { fs::remove_all(folder); }
    std::size_t file_count() const {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder), fs::directory_iterator{}));
    }
    const fs::path folder = fs::temp_directory_path() / ("tessera-cache-test-" + std::to_string(::getpid()));
};

TEST_F(BlobCacheTest, PersistsAcrossProcesses) {
    const scene::Blob one = blob('a');
    BlobCache(folder, 1 << 20).save(one);
    const scene::BlobPtr loaded = BlobCache(folder, 1 << 20).load(reference(one));
    ASSERT_TRUE(loaded);
    EXPECT_EQ(loaded->hash(), one.hash());
    EXPECT_TRUE(
        std::equal(loaded->bytes().begin(), loaded->bytes().end(), one.bytes().begin(), one.bytes().end()));
    EXPECT_EQ(BlobCache(folder, 1 << 20).load(reference(blob('b'))), nullptr);
}

TEST_F(BlobCacheTest, DamagedFilesAreRemoved) {
    const scene::Blob one = blob('a'), two = blob('b');
    BlobCache cache(folder, 1 << 20);
    cache.save(one);
    cache.save(two);
    std::fstream(folder / to_hex(one.hash())).seekp(500).put('x');
    fs::resize_file(folder / to_hex(two.hash()), 999);
    EXPECT_EQ(cache.load(reference(one)), nullptr);
    EXPECT_EQ(cache.load(reference(two)), nullptr);
    EXPECT_EQ(file_count(), 0u);
}

TEST_F(BlobCacheTest, EvictsTheLeastRecentlyUsed) {
    BlobCache cache(folder, 3500);
    const scene::Blob a = blob('a'), b = blob('b'), c = blob('c'), d = blob('d');
    const auto age = [&](const scene::Blob& which, int hours) {
        fs::last_write_time(folder / to_hex(which.hash()),
                            fs::file_time_type::clock::now() - std::chrono::hours(hours));
    };
    for (const scene::Blob* which : {&a, &b, &c}) cache.save(*which);
    age(a, 3);
    age(b, 2);
    age(c, 1);
    EXPECT_TRUE(cache.load(reference(a)));  // used just now
    cache.save(d);
    EXPECT_EQ(cache.load(reference(b)), nullptr);
    for (const scene::Blob* which : {&a, &c, &d}) EXPECT_TRUE(cache.load(reference(*which)));
}

TEST_F(BlobCacheTest, BlobsLargerThanTheLimitAreNotStored) {
    BlobCache cache(folder, 500);
    cache.save(blob('a'));
    EXPECT_EQ(file_count(), 0u);
}

TEST_F(BlobCacheTest, AFolderThatCannotBeCreatedIsAnError) {
    std::ofstream(folder.string()) << "a file";
    EXPECT_THROW(BlobCache(folder, 500), Error);
}

}  // namespace
}  // namespace tessera::node
