#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "mediator/base/error.h"
#include "mediator/base/random.h"
#include "mediator/frame/merge.h"
#include "mediator/frame/resolve.h"
#include "mediator/picture/exr_reader.h"
#include "mediator/picture/exr_writer.h"
#include "mediator/picture/film_exr.h"
#include "mediator/picture/hdr_reader.h"
#include "mediator/picture/png_writer.h"
#include "mediator/picture/view_transform.h"

namespace tessera::picture {
namespace {

namespace fs = std::filesystem;

struct PictureTest : testing::Test {
    fs::path folder = fs::temp_directory_path() / ("tessera-picture-" + std::to_string(getpid()));
    void SetUp() override { fs::create_directories(folder); }
    void TearDown() override { fs::remove_all(folder); }
    std::string file(const std::string& name) const { return (folder / name).string(); }
    std::size_t files() const {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
    }
    std::string bytes_of(const std::string& path) const {
        std::ifstream in(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void put(const std::string& path, const std::string& bytes) const {
        std::ofstream(path, std::ios::binary) << bytes;
    }
};

frame::Image noise(std::uint32_t width, std::uint32_t height, std::uint64_t seed) {
    frame::Image image(width, height, 3);
    CounterRandom random(seed);
    for (float& value : image.values) value = static_cast<float>(std::exp(20.0 * random.uniform() - 10.0));
    return image;
}

frame::FilmTile some_film(const Rect& window) {
    frame::FilmTile film(window, {0, 0},
                         {frame::Channel::Radiance, frame::Channel::Depth, frame::Channel::ObjectIndex});
    CounterRandom random(4);
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        const float v = static_cast<float>(random.uniform()), depth = static_cast<float>(i);
        const std::array<float, 6> values{
            v, 2 * v, 3 * v, depth, depth, std::bit_cast<float>(static_cast<std::uint32_t>(70000 + i))};
        frame::put_sample(film, i, values);
    }
    return film;
}

TEST_F(PictureTest, ExrRoundTripsBitByBitInItsWindow) {
    const Rect window{5, 7, 13, 9};
    const frame::FilmTile film = some_film(window);
    write_film_exr(file("a.exr"), {64, 32, film, {{"tessera/seed", "5"}}});
    const Picture radiance = read_exr(file("a.exr"));
    EXPECT_EQ(radiance.window, window);
    EXPECT_EQ(radiance.image.values, frame::resolve(film, frame::Channel::Radiance).values);
    EXPECT_EQ(read_exr(file("a.exr"), "depth").image.values,
              frame::resolve(film, frame::Channel::Depth).values);
    const Picture ids = read_exr(file("a.exr"), "object_id");
    for (std::size_t i = 0; i < ids.image.values.size(); ++i) {
        EXPECT_EQ(ids.image.values[i], static_cast<float>(70000 + i));
    }
    EXPECT_EQ(read_exr(file("a.exr"), "samples").image.values,
              std::vector<float>(window.pixel_count(), 1.0f));
    EXPECT_THROW(read_exr(file("a.exr"), "nonsense"), Error);
    EXPECT_EQ(files(), 1u) << "a temporary file is left";
}

TEST_F(PictureTest, DamagedExrIsAnErrorAndNeverACrash) {
    write_film_exr(file("a.exr"), {16, 16, some_film({0, 0, 16, 16}), {}});
    const std::string good = bytes_of(file("a.exr"));
    CounterRandom random(11);
    for (int i = 0; i < 400; ++i) {
        std::string bad = good;
        if (i % 2 == 0) {
            bad.resize(random.below(good.size()));
        } else {
            for (int f = 0; f < 4; ++f)
                bad[random.below(bad.size())] ^= static_cast<char>(1u << random.below(8));
        }
        put(file("b.exr"), bad);
        try {
            (void)read_exr(file("b.exr"));
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("b.exr"), std::string::npos) << "the file is not named";
        }
        if (i % 2 != 0) continue;
        EXPECT_THROW(read_exr(file("b.exr")), Error) << "cut to " << bad.size();
    }
    EXPECT_THROW(read_exr(file("missing.exr")), Error);
}

TEST_F(PictureTest, AnExrIsTheSameFileWithAnyNumberOfThreads) {
    const std::vector<Layer> layers{{"", {"R", "G", "B"}, noise(70, 99, 1)}};
    write_exr(file("a.exr"), 70, 99, {0, 0, 70, 99}, layers, {});
    set_exr_threads(4);
    write_exr(file("b.exr"), 70, 99, {0, 0, 70, 99}, layers, {});
    set_exr_threads(0);
    EXPECT_EQ(bytes_of(file("a.exr")), bytes_of(file("b.exr")));
}

// OpenEXR reads as much as the type takes, and then other attributes than the header has.
TEST_F(PictureTest, ExrAttributesHaveTheSizeOfTheirType) {
    write_exr(file("a.exr"), 5, 3, {0, 0, 5, 3}, {{"", {"R", "G", "B"}, noise(5, 3, 1)}}, {});
    const std::string good = bytes_of(file("a.exr"));
    const auto with_size = [&](const std::string& name_and_type, char size) {
        std::string bad = good;
        const std::size_t at = bad.find(name_and_type);
        EXPECT_NE(at, bad.npos) << name_and_type;
        bad[at + name_and_type.size()] = size;
        return bad;
    };
    using namespace std::string_literals;
    const std::string preview = "preview\0preview\0\x0c\0\0\0\xff\xff\0\0\xff\xff\0\0abcd"s;
    const std::string bad[] = {with_size("screenWindowWidth\0float\0"s, 8),
                               with_size("lineOrder\0lineOrder\0"s, 4), with_size("channels\0chlist\0"s, 30),
                               good.substr(0, 8) + preview + good.substr(8)};
    for (const std::string& bytes : bad) {
        put(file("b.exr"), bytes);
        try {
            (void)read_exr(file("b.exr"));
            ADD_FAILURE() << "it is read";
        } catch (const Error& error) {
            const std::string text = error.what();
            EXPECT_TRUE(text.find("wrong size") != text.npos || text.find("another size") != text.npos)
                << text;
        }
    }
}

TEST_F(PictureTest, DamagedHdrIsAnError) {
    const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
    put(file("a.hdr"), head + "-Y 1 +X 2\n" + std::string("\x80\x80\x80\x81\x40\x40\x40\x81", 8));
    const frame::Image image = read_hdr(file("a.hdr"));
    EXPECT_EQ(image.width, 2u);
    EXPECT_NEAR(image.values[0], 1.0f, 0.01f);
    for (const std::string& bad : {head + "-Y 1 +X 2\n\x80", head + "-Y 999999999 +X 999999999\n",
                                   std::string("nothing"), head + "-Y -1 +X 2\n"}) {
        put(file("b.hdr"), bad);
        EXPECT_THROW(read_hdr(file("b.hdr")), Error);
    }
}

TEST_F(PictureTest, AFailedWriteLeavesNoFile) {
    EXPECT_THROW(write_film_exr(file("no/folder/a.exr"), {4, 4, some_film({0, 0, 4, 4}), {}}), Error);
    EXPECT_THROW(write_png(file("no/folder/a.png"), 1, 1, std::array<std::uint8_t, 3>{}), Error);
    EXPECT_EQ(files(), 0u);
}

TEST_F(PictureTest, PngHoldsTheBytes) {
    const frame::Image image = noise(20, 10, 3);
    const auto bytes = srgb_bytes(image, {view::ViewTransform::Neutral, 0.0});
    write_png(file("a.png"), 20, 10, bytes);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    ASSERT_NE(png_image_begin_read_from_file(&png, file("a.png").c_str()), 0);
    png.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> read(PNG_IMAGE_SIZE(png));
    ASSERT_NE(png_image_finish_read(&png, nullptr, read.data(), 0, nullptr), 0);
    EXPECT_EQ(read, bytes);
}

}  // namespace
}  // namespace tessera::picture
