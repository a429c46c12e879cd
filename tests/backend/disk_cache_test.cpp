#include "mediator/base/disk_cache.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

namespace tessera {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

Bytes bytes(char fill, std::size_t size = 1000) {
    return Bytes(size, std::byte(fill));
}
Hash256 key(char name) {
    return blake2b(bytes(name, 1));
}

struct DiskCacheTest : testing::Test {
    DiskCacheTest() { fs::remove_all(folder); }
    ~DiskCacheTest() override { fs::remove_all(folder); }
    fs::path path(char name) const { return folder / (to_hex(key(name)) + ".tree"); }
    const fs::path folder = fs::temp_directory_path() / ("tessera-disk-cache-" + std::to_string(::getpid()));
};

TEST_F(DiskCacheTest, LoadsWhatAnotherProcessSaved) {
    DiskCache(folder, "tree", 1 << 20).save(key('a'), bytes('x'));
    DiskCache cache(folder, "tree", 1 << 20);
    EXPECT_EQ(cache.load(key('a')), std::optional(bytes('x')));
    EXPECT_EQ(cache.load(key('b')), std::nullopt);
    EXPECT_EQ(DiskCache(folder, "other", 1 << 20).load(key('a')), std::nullopt);
    EXPECT_TRUE(cache.take_notes().empty());
    cache.save(key('e'), {});
    EXPECT_EQ(cache.load(key('e')), std::optional(Bytes()));
}

TEST_F(DiskCacheTest, DamagedEntriesAreReportedRemovedAndNotLoaded) {
    DiskCache cache(folder, "tree", 1 << 20);
    for (const char name : {'a', 'b', 'c', 'd'}) cache.save(key(name), bytes(name));
    std::fstream(path('a')).seekp(500).put('?');  // in the data
    std::fstream(path('b')).seekp(20).put('?');   // in the header
    fs::resize_file(path('c'), 700);
    fs::rename(path('d'), path('e'));  // another one's
    for (const char name : {'a', 'b', 'c', 'e'}) {
        EXPECT_EQ(cache.load(key(name)), std::nullopt) << name;
        const std::vector<std::string> notes = cache.take_notes();
        ASSERT_EQ(notes.size(), 1u) << name;
        EXPECT_NE(notes[0].find(path(name).string()), std::string::npos) << notes[0];
        EXPECT_FALSE(fs::exists(path(name))) << name;
    }
}

TEST_F(DiskCacheTest, EvictsLeastRecentlyUsedFirstAndKeepsForeignFiles) {
    DiskCache cache(folder, "tree", 3500);
    std::ofstream(folder / "blob") << std::string(100000, 'b');
    for (const char name : {'a', 'b', 'c'}) {
        cache.save(key(name), bytes(name));
        fs::last_write_time(path(name), fs::file_time_type::clock::now() - std::chrono::hours('d' - name));
    }
    EXPECT_TRUE(cache.load(key('a')));  // used just now
    cache.save(key('d'), bytes('d'));
    EXPECT_FALSE(cache.load(key('b')));
    for (const char name : {'a', 'c', 'd'}) EXPECT_TRUE(cache.load(key(name))) << name;
    cache.save(key('e'), bytes('e', 4000));
    EXPECT_FALSE(cache.load(key('e'))) << "larger than all";
    EXPECT_TRUE(fs::exists(folder / "blob"));
}

TEST_F(DiskCacheTest, WithoutAFolderNothingIsSaved) {
    DiskCache none("", "tree", 1 << 20);
    none.save(key('a'), bytes('a'));
    EXPECT_EQ(none.load(key('a')), std::nullopt);
    EXPECT_TRUE(none.take_notes().empty());

    std::ofstream(folder.string()) << "a file";
    DiskCache blocked(folder, "tree", 1 << 20);
    blocked.save(key('a'), bytes('a'));
    EXPECT_EQ(blocked.load(key('a')), std::nullopt);
    EXPECT_FALSE(blocked.take_notes().empty());
}

}  // namespace
}  // namespace tessera
