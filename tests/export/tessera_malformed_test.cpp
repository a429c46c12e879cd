#include <cstring>
#include <fstream>
#include <iterator>

#include "client/export/export.h"
#include "client/import/tessera_format.h"
#include "mediator/base/random.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/validate.h"
#include "mediator/wire/envelope.h"
#include "tests/export/rich_scene.h"
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

// Malformed files: reading gives a valid scene or an error, nothing else.
namespace tessera::exporting {
namespace {

constexpr std::size_t HashBytes = 32;

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// With a corrected checksum.
std::string sealed(std::string bytes) {
    bytes.resize(bytes.size() - HashBytes);
    const Hash256 hash = blake2b(std::as_bytes(std::span(bytes)));
    return bytes + std::string(reinterpret_cast<const char*>(hash.bytes.data()), HashBytes);
}

template <class T>
std::string with_number(std::string bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return sealed(std::move(bytes));
}

class TesseraMalformed : public testing::Test {
  protected:
    void SetUp() override {
        make_rich(rich_);
        const auto file = folder_.path() / "whole.tessera";
        ASSERT_TRUE(write_tessera(rich_.scene, rich_.blobs, file));
        whole_ = bytes_of(file);
    }

    // The error message, or "" if the file was read; then it must be valid and importable.
    std::string error_of(const std::string& bytes) {
        const auto file = folder_.write("bad.tessera", bytes);
        const auto read = import::read_tessera(file);
        const auto imported = import::import_scene(file);
        EXPECT_EQ(read.has_value(), imported.has_value());
        if (!read) {
            EXPECT_NE(read.error().code(), ErrorCode::Internal);
            EXPECT_STRNE(read.error().what(), "");
            return read.error().what();
        }
        scene::Scene scene;
        EXPECT_TRUE(scene.apply(read->snapshot));
        EXPECT_TRUE(scene::validate(scene).empty());
        return {};
    }

    import::TestFolder folder_;
    RichScene rich_;
    std::string whole_;
};

TEST_F(TesseraMalformed, TheUndamagedFileIsRead) {
    EXPECT_EQ(error_of(whole_), "");
    EXPECT_EQ(sealed(whole_), whole_);
}

TEST_F(TesseraMalformed, EveryTruncationIsAnError) {
    for (std::size_t length = 0; length < whole_.size(); length += length < 100 ? 1 : 13) {
        EXPECT_NE(error_of(whole_.substr(0, length)), "") << length;
        if (length >= HashBytes) {
            EXPECT_NE(error_of(sealed(whole_.substr(0, length))), "") << length;
        }
    }
}

TEST_F(TesseraMalformed, EveryFlippedBitIsAnError) {
    for (std::size_t at = 0; at < whole_.size(); at += at < 64 ? 1 : 7) {
        std::string damaged = whole_;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
        EXPECT_NE(error_of(damaged), "") << at;
    }
}

TEST_F(TesseraMalformed, FlippedBitsWithACorrectedChecksum) {
    CounterRandom random(5);
    std::map<std::string, int> causes;
    for (int round = 0; round < 1500; ++round) {
        std::string damaged = whole_;
        for (std::uint64_t flips = 1 + random.below(3); flips > 0; --flips) {
            char& byte = damaged[random.below(damaged.size() - HashBytes)];
            byte = static_cast<char>(byte ^ (1 << random.below(8)));
        }
        ++causes[error_of(sealed(damaged)).substr(0, 40)];
    }
    EXPECT_GT(causes.size(), 4u) << "damage that always stops at the same check tests nothing behind it";
}

TEST_F(TesseraMalformed, AbsurdNumbersAreAnError) {
    constexpr std::size_t Version = 8, Blobs = 12, List = 16;
    EXPECT_THAT(error_of(with_number(whole_, Version, std::uint32_t{2})), testing::HasSubstr("version is 2"));
    for (const std::uint32_t count : {0u, 1u, 1000u, ~0u}) {
        EXPECT_THAT(error_of(with_number(whole_, Blobs, count)), testing::HasSubstr("blobs")) << count;
    }
    for (const std::uint64_t size : {0ull, 1ull, 1ull << 40, ~0ull, ~0ull - 8}) {
        EXPECT_NE(error_of(with_number(whole_, List, size)), "") << size;
    }
    std::uint64_t list_size = 0;
    std::memcpy(&list_size, whole_.data() + List, sizeof list_size);
    const std::size_t blob_size = import::TesseraHeaderBytes + list_size + HashBytes;
    for (const std::uint64_t size : {0ull, 1ull, 1ull << 40, ~0ull}) {
        EXPECT_NE(error_of(with_number(whole_, blob_size, size)), "") << size;
    }
}

TEST_F(TesseraMalformed, TrailingBytesAreAnError) {
    EXPECT_THAT(error_of(sealed(whole_ + "x")), testing::HasSubstr("trailing bytes"));
}

// The file with another change list in front of the same blobs.
std::string with_list(const std::string& whole, const scene::ChangeList& list) {
    std::uint64_t old_size = 0;
    std::memcpy(&old_size, whole.data() + 16, sizeof old_size);
    const std::vector<std::byte> encoded = wire::encode(list);
    const std::uint64_t size = encoded.size();
    std::string bytes = whole.substr(0, 16);
    bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
    bytes.append(reinterpret_cast<const char*>(encoded.data()), encoded.size());
    return sealed(bytes + whole.substr(24 + old_size));
}

TEST_F(TesseraMalformed, InvalidScenesAreAnError) {
    const scene::ChangeList good = scene::snapshot(rich_.scene);
    EXPECT_EQ(error_of(with_list(whole_, good)), "");

    scene::ChangeList follows = good;
    follows.from.number = 3;
    EXPECT_THAT(error_of(with_list(whole_, follows)), testing::HasSubstr("not a snapshot"));

    scene::ChangeList corrupted = good;
    corrupted.state_hash.low ^= 1;
    EXPECT_THAT(error_of(with_list(whole_, corrupted)), testing::HasSubstr("state hash"));

    const auto changed = [&](const scene::Entry& entry) {
        scene::Scene scene = rich_.scene;
        EXPECT_TRUE(scene.apply_entries(std::vector<scene::Entry>(1, entry)));
        return error_of(with_list(whole_, scene::snapshot(scene)));
    };
    EXPECT_THAT(changed(scene::Remove{scene::RootId}), testing::HasSubstr("no root"));
    using Root = scene::Root;
    scene::Root root = *rich_.scene.find_as<Root>(scene::RootId);
    root.children.push_back(ObjectId{4000});
    const auto children = scene::Fields<Root>(&Root::children).bits();
    EXPECT_THAT(changed(scene::Update{scene::RootId, children, root}), testing::HasSubstr("not there"));

    // A transform that is its own ancestor: traversing the graph before validation would not end.
    scene::Transform cycle{.name = "cycle", .children = {ObjectId{500}}};
    EXPECT_THAT(changed(scene::Create{ObjectId{500}, cycle}), testing::HasSubstr("its own descendants"));
}

TEST_F(TesseraMalformed, AnExponentialGraphIsAnError) {
    scene::Scene scene;
    std::vector<scene::Entry> entries{scene::Create{scene::RootId, scene::Root{.children = {ObjectId{2}}}}};
    for (std::uint64_t level = 2; level < 66; ++level) {
        scene::Transform twice{.name = "level"};
        if (level < 65) twice.children = {ObjectId{level + 1}, ObjectId{level + 1}};
        entries.emplace_back(scene::Create{ObjectId{level}, twice});
    }
    ASSERT_TRUE(scene.apply_entries(entries));
    const auto file = folder_.path() / "deep.tessera";
    ASSERT_TRUE(write_tessera(scene, rich_.blobs, file));
    const auto imported = import::import_scene(file);
    ASSERT_FALSE(imported);
    EXPECT_THAT(imported.error().what(), testing::HasSubstr("object instances"));
    const auto glb = write_glb(scene, rich_.blobs, folder_.path() / "deep.glb");
    ASSERT_FALSE(glb);
    EXPECT_THAT(glb.error().what(), testing::HasSubstr("expands to more than"));
}

}  // namespace
}  // namespace tessera::exporting
