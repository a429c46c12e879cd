// Films in EXR files: all statistics come back to the bit, and damage is an error.
#include "mediator/picture/film_exr.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "mediator/base/error.h"
#include "mediator/base/random.h"
#include "mediator/frame/design_effect.h"
#include "mediator/frame/resolve.h"
#include "mediator/picture/exr_reader.h"
#include "mediator/picture/noise_map.h"
#include "mediator/picture/picture_encoder.h"
#include "tests/filter/synthetic.h"

namespace tessera::picture {
namespace {

class FilmExr : public testing::Test {
  protected:
    FilmExr() {
        folder_ = std::filesystem::temp_directory_path() / ("tessera-film-" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
    }
    ~FilmExr() override { std::filesystem::remove_all(folder_); }
    std::string file(const std::string& name) const { return (folder_ / name).string(); }

    static frame::FilmTile film() {
        return filter::synthetic_film(37, 23, 5, filter::EveryChannel, [](auto x, auto y, auto i) {
            auto sample = filter::shadowed_texture(37, 23, x, y, i);
            sample.low = {0.125f * float(i), 0.0f, 1e-30f};
            sample.object = x < 10 ? 0u : 0x7fc00001u;  // bits that are no number
            sample.depth = x < 10 ? std::numeric_limits<float>::infinity() : 2.0f;
            return sample;
        });
    }

    std::filesystem::path folder_;
};

TEST_F(FilmExr, RoundTripsStatisticsBitByBit) {
    frame::FilmTile original = film();
    original.rect.x = 3;
    original.rect.y = 4;
    frame::Image filtered(37, 23, 4);
    for (std::size_t i = 0; i < filtered.values.size(); ++i) filtered.values[i] = float(i) * 0.5f;
    write_film_exr(file("a.exr"), {64, 32, original, {{"tessera.seed", "5"}}}, filtered, Statistics::Include);
    const FilmFile back = read_film_exr(file("a.exr"));
    EXPECT_TRUE(frame::identical_bits(back.film, original));
    EXPECT_EQ(back.width, 64u);
    EXPECT_EQ(back.height, 32u);
    EXPECT_EQ(back.attributes.at("tessera.seed"), "5");
    EXPECT_EQ(read_exr(file("a.exr"), "raw").image.values,
              frame::resolve(original, frame::Channel::Radiance).values);
    const Picture main = read_exr(file("a.exr"));
    for (std::size_t i = 0; i < main.image.pixel_count(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(main.image.pixel(i)[c], filtered.pixel(i)[c]);
    }
}

// Variance of the mean, of stratified samples, and of single samples.
TEST_F(FilmExr, SaysWhatItsVariancesAreOf) {
    const frame::FilmTile original = film();
    write_film_exr(file("a.exr"), {37, 23, original, {}}, {}, Statistics::Include);
    EXPECT_EQ(read_film_exr(file("a.exr")).attributes.at("tessera.varianceOf"), "mean-stratified");
    const frame::Image independent = frame::resolve_variance_of_mean(original, frame::Channel::Radiance);
    frame::DesignEffect design_effect;
    const std::span<const float> effect = design_effect.measure(original);
    const frame::Image mean = read_exr(file("a.exr"), "variance").image,
                       sample = read_exr(file("a.exr"), "sample_variance").image;
    bool is_reduced = false;
    for (std::size_t i = 0; i < independent.values.size(); ++i) {
        EXPECT_EQ(mean.values[i], independent.values[i] * effect[i / 3]);
        EXPECT_FLOAT_EQ(sample.values[i], independent.values[i] * 5.0f);
        is_reduced = is_reduced || effect[i / 3] < 1.0f;
    }
    EXPECT_TRUE(is_reduced);
}

// The root of the noise layer's mean square is about that of relMSE: deviations are averaged over neighbours.
TEST_F(FilmExr, HasAMapOfItsNoise) {
    const frame::FilmTile original = film();
    write_film_exr(file("a.exr"), {37, 23, original, {}});
    const Picture noise = read_exr(file("a.exr"), "noise");
    const NoiseMap map(original);
    ASSERT_EQ(noise.image.pixel_count(), original.pixel_count());
    double sum = 0.0;
    for (std::size_t i = 0; i < original.pixel_count(); ++i) {
        const float value = noise.image.pixel(i)[0];
        EXPECT_FLOAT_EQ(value, map.deviations()[i] / std::sqrt(float(original.counts[i])));
        sum += double(value) * double(value) / double(original.pixel_count());
    }
    EXPECT_NEAR(std::sqrt(sum) / map.noise(), 1.0, 0.3);
}

// Older films have half buffers of even samples, and no block variances.
TEST_F(FilmExr, OldFilmsAreRead) {
    frame::FilmTile old({0, 0, 5, 4}, {0, 0}, {frame::Channel::Radiance, frame::Channel::HalfBufferA});
    std::ranges::fill(old.counts, 16u);
    for (std::size_t i = 0; i < old.planes.size(); ++i) old.planes[i] = 0.25f * float(i);
    write_film_exr(file("a.exr"), {5, 4, old, {}}, {}, Statistics::Include);
    const FilmFile back = read_film_exr(file("a.exr"));
    EXPECT_TRUE(frame::identical_bits(back.film, old));
    EXPECT_EQ(back.attributes.at("tessera.varianceOf"), "mean-independent");
    EXPECT_EQ(read_exr(file("a.exr"), "variance").image.values,
              frame::resolve_variance_of_mean(old, frame::Channel::Radiance).values);
}

TEST_F(FilmExr, WithOnlyColorColorIsThePicture) {
    const frame::FilmTile color = frame::with_channels(film(), {frame::Channel::Color});
    write_film_exr(file("a.exr"), {37, 23, color, {}}, {}, Statistics::Include);
    EXPECT_TRUE(frame::identical_bits(read_film_exr(file("a.exr")).film, color));
    const Picture main = read_exr(file("a.exr"));
    EXPECT_EQ(main.image.values, frame::resolve(color, frame::Channel::Color).values);
    const frame::FilmTile albedo = frame::with_channels(film(), {frame::Channel::Albedo});
    write_film_exr(file("b.exr"), {37, 23, albedo, {}}, {}, Statistics::Include);
    EXPECT_THROW(read_film_exr(file("b.exr")), Error) << "no picture is in it";
}

TEST_F(FilmExr, WithoutStatisticsTheErrorHasTheRemedy) {
    write_film_exr(file("a.exr"), {37, 23, film(), {}});
    try {
        (void)read_film_exr(file("a.exr"));
        FAIL() << "a file without statistics was read";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("--save-statistics"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("a.exr"), std::string::npos);
    }
    EXPECT_THROW(read_film_exr(file("missing.exr")), Error);
    EXPECT_THROW(read_film_exr(folder_.string()), Error);
}

TEST_F(FilmExr, DamageIsAnErrorAndNeverACrash) {
    write_film_exr(file("a.exr"), {37, 23, film(), {}}, {}, Statistics::Include);
    std::ifstream in(file("a.exr"), std::ios::binary);
    const std::string good((std::istreambuf_iterator<char>(in)), {});
    CounterRandom random(3);
    for (int i = 0; i < 200; ++i) {
        std::string bad = good;
        if (i % 2 == 0) {
            bad.resize(random.below(good.size()));
        } else {
            for (int f = 0; f < 4; ++f) bad[random.below(4096)] ^= static_cast<char>(1u << random.below(8));
        }
        std::ofstream(file("b.exr"), std::ios::binary) << bad;
        try {
            const FilmFile read = read_film_exr(file("b.exr"));
            EXPECT_EQ(read.film.planes.size(), read.film.channels.plane_count() * read.film.pixel_count());
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("b.exr"), std::string::npos);
        }
    }
}

TEST_F(FilmExr, ImpossibleValuesAreDamage) {
    for (const float value : {std::numeric_limits<float>::quiet_NaN(), -1.0f}) {
        frame::FilmTile bad = film();
        bad.plane(4)[7] = value;  // M2 of green radiance
        write_film_exr(file("a.exr"), {37, 23, bad, {}}, {}, Statistics::Include);
        EXPECT_THROW(read_film_exr(file("a.exr")), Error) << value;
        frame::FilmTile worse = film();
        worse.plane(worse.channels.first_plane(frame::Channel::BlockVariance))[7] = value;
        write_film_exr(file("a.exr"), {37, 23, worse, {}}, {}, Statistics::Include);
        EXPECT_THROW(read_film_exr(file("a.exr")), Error) << value;
    }
}

// Encoded in memory: straight alpha in PNG, premultiplied in EXR.
TEST_F(FilmExr, EncodedPicturesKeepAlpha) {
    frame::Image image(2, 1, 4);
    image.values = {0.25f, 0.5f, 0.125f, 0.5f, 0.0f, 0.0f, 0.0f, 0.0f};
    const std::vector<std::byte> exr = encode_picture(image, FileFormat::Exr, {});
    std::ofstream(file("c.exr"), std::ios::binary)
        .write(reinterpret_cast<const char*>(exr.data()), static_cast<std::streamsize>(exr.size()));
    const Picture back = read_exr(file("c.exr"));
    EXPECT_EQ(back.image.pixel(0)[1], 0.5f);
    EXPECT_EQ(read_exr(file("c.exr")).image.components, 3u) << "alpha is left out of comparisons";
    for (const FileFormat format : {FileFormat::Png, FileFormat::Jpeg}) {
        EXPECT_GT(encode_picture(image, format, {}).size(), 20u);
    }
    image.values[0] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_GT(encode_picture(image, FileFormat::Png, {}).size(), 20u) << "NaN is black";
}

}  // namespace
}  // namespace tessera::picture
