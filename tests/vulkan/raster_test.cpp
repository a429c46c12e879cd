// Rasterised hits against ray hits, on every triangle of the scene and under the validation layer; and the radiance
// of the raster renderer against that of Whitted.
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "mediator/frame/merge.h"
#include "mediator/frame/resolve.h"
#include "tests/vulkan/raster_fixture.h"

namespace tessera::vulkan {
namespace {

using test::moved;

// Spheres in front of a wall that fills the picture, at any size and position.
struct Place {
    double scale;
    glm::dvec3 center;
};

class RasterAnywhere : public RasterTest, public testing::WithParamInterface<Place> {};

// Pixels that an edge cuts may show either side: the rasteriser rounds corners to parts of a pixel.
TEST_P(RasterAnywhere, MatchesRays) {
    const auto& [scale, center] = GetParam();
    const auto at = [&](double x, double y, double z) {
        const glm::dvec3 place = center + scale * glm::dvec3(x, y, z);
        return moved(place.x, place.y, place.z);
    };
    place(square(9.0 * scale), at(0, 0, -6));
    for (int i = 0; i < 5; ++i)
        place(sphere(0.4 * scale, 8), at(0.7 * i - 1.4, 0.3 * i - 0.6, -2.5 - 0.4 * i));
    build(glm::round(center / 256.0) * 256.0);
    const view::View view = view_from(center, 64, 48);
    std::size_t different = 0;
    for (std::uint64_t index = 0; index < 4; ++index) different += differing(view, index, 1e-3);
    // Edges are as long as 400 pixels in a picture; a 256th of a pixel to both sides makes 3 of them. Far
    // from the origin, places are rounded to parts of a pixel, too.
    EXPECT_LE(different, 4u * 12u);
}

INSTANTIATE_TEST_SUITE_P(Places, RasterAnywhere,
                         testing::Values(Place{1.0, {}}, Place{1e-4, {}}, Place{1e-9, {}}, Place{1e6, {}},
                                         Place{1e11, {}}, Place{1.0, {1e6, -3e6, 2e6}},
                                         Place{1.0, {200.3, 100.7, -250.1}}));

TEST_F(RasterTest, MatchesRaysInAnOffAxisFrustum) {
    place(square(20.0), moved(0, 0, -6));
    for (int i = 0; i < 5; ++i) place(sphere(0.5, 8), moved(i - 2.0, 0.5 * i, -3));
    build();
    view::View view = view_from({}, 60, 40);
    view.camera.left = 0.1;
    view.camera.right = 0.9;
    view.camera.bottom = -0.3;
    view.camera.top = 0.7;
    EXPECT_LE(differing(view, 1), 12u);
    view.pixel_filter = {view::PixelFilterKind::Gaussian, 1.5f};
    EXPECT_LE(differing(view, 2), 12u);
}

// A floor that extends behind the eye, walls through the eye, a sphere around it, both windings.
TEST_F(RasterTest, DrawsTrianglesThatCrossTheEyePlane) {
    const ObjectId floor = mesh({{-1000, -1, 1000}, {1000, -1, 1000}, {0, -1, -1000}}, {0, 1, 2});
    const ObjectId roof = mesh({{-1000, 1, 1000}, {1000, 1, 1000}, {0, 1, -1000}}, {0, 2, 1});
    place(floor, moved(0, 0, 0));
    place(roof, moved(0, 0, 0));
    place(sphere(30.0, 6), moved(1, 2, 3));
    place(sphere(0.4, 6), moved(0.5, 0.1, -2));
    const ObjectId needle = mesh({{-3, -0.2f, 2}, {0.1f, 0.2f, -4}, {0.15f, 0.15f, -4}}, {0, 1, 2});
    place(needle, moved(0, 0, 0));
    build();
    const view::View view = view_from({}, 64, 48);
    for (std::uint64_t index = 0; index < 4; ++index) EXPECT_LE(differing(view, index, 1e-3), 12u) << index;
}

TEST_F(RasterTest, SkipsDegenerateTriangles) {
    place(square(5.0), moved(0, 0, -4));
    const ObjectId none =
        mesh({{-1, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1, 1, 0}}, {0, 1, 2, 1, 1, 3, 3, 3, 3, 0, 0, 0});
    place(none, moved(0, 0, -2));
    place(square(1.0), glm::scale(moved(0, 0, -2), glm::dvec3(1, 0, 0)));  // flat, without an inverse
    build();
    EXPECT_EQ(differing(view_from({}, 40, 30), 0), 0u);
}

// Leaves with holes, and partly transparent panes: the alpha tests of rays.
TEST_F(RasterTest, AlphaTestsMatchRays) {
    scene::Material pane;
    pane.alpha_mode = scene::AlphaMode::Blend;
    pane.base_color.a = 0.5f;
    scene::Material hole;
    hole.alpha_mode = scene::AlphaMode::Mask;
    hole.base_color.a = 0.4f;
    hole.alpha_cutoff = 0.5f;
    const ObjectId half = square(1.0, material(pane)), nothing = square(1.0, material(hole));
    place(square(5.0), moved(0, 0, -5));
    for (int i = 0; i < 3; ++i) place(half, moved(0.3 * i, 0.2 * i, -2.0 - 0.5 * i));
    place(nothing, moved(0, 0, -1.5));
    build();
    const view::View view = view_from({}, 64, 48);
    for (std::uint64_t index = 0; index < 4; ++index) EXPECT_LE(differing(view, index), 12u) << index;
}

TEST_F(RasterTest, CoincidentTrianglesResolveToTheLowestIndexAsForRays) {
    const ObjectId twice = mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}}, {0, 1, 2, 0, 1, 2});
    const ObjectId wall = square(1.0), same = square(1.0);
    place(twice, moved(0, 0, -3));
    place(wall, moved(0, 0, -2));
    place(same, moved(0, 0, -2));
    build();
    const view::View view = view_from({}, 32, 32);
    EXPECT_LE(differing(view, 0), 2u);
    for (const RasterSettings::Culling culling :
         {RasterSettings::Culling::Off, RasterSettings::Culling::On}) {
        const auto seen = seen_in(film(view, {0, 0}, {culling, 1}), view.channels);
        EXPECT_EQ(
            std::count_if(seen.begin(), seen.end(), [&](const Seen& s) { return s.object == same.value; }),
            0);
    }
}

TEST_F(RasterTest, AnEmptySceneIsEmpty) {
    build();
    const view::View view = view_from({}, 16, 16);
    for (const Seen& seen : seen_in(film(view, {0, 1}), view.channels)) {
        EXPECT_EQ(seen.object, 0u);
        EXPECT_EQ(seen.depth, shading::infinity());
    }
}

// Also across the border of a cell, which is at pixel 2048.
TEST_F(RasterTest, TilesMatchTheWholePictureBitForBit) {
    place(square(9.0), moved(0, 0, -6));
    for (int i = 0; i < 9; ++i) place(sphere(0.3, 6), moved(0.5 * i - 2.0, 0.1 * i, -3));
    light({0, 3, 0}, 50.0f);
    build();
    view::View view = view_from({}, 2112, 40);
    view.camera = view::perspective(glm::dmat4(1.0), 0.05, 2112.0 / 40.0);
    const frame::FilmTile whole = film(view, {3, 0});
    std::mt19937 random(2);
    std::vector<Rect> tiles{{2040, 3, 20, 30}, {2048, 0, 64, 40}, {2047, 39, 1, 1}};
    for (int i = 0; i < 6; ++i) {
        const std::int32_t x = std::int32_t(random() % 2100), y = std::int32_t(random() % 36);
        tiles.push_back({x, y, 1 + std::int32_t(random() % std::uint32_t(2112 - x)) % 90, 1 + (40 - y) / 2});
    }
    for (const Rect& tile : tiles) {
        const frame::FilmTile part = film(view, tile, {3, 0});
        for (std::uint32_t plane = 0; plane < view.channels.plane_count(); ++plane) {
            for (std::int32_t y = 0; y < tile.height; ++y) {
                const auto* row = whole.plane(plane).data() + (tile.y + y) * 2112 + tile.x;
                ASSERT_EQ(std::memcmp(part.plane(plane).data() + std::ptrdiff_t{y} * tile.width, row,
                                      sizeof(float) * std::size_t(tile.width)),
                          0)
                    << "plane " << plane << " of the tile at " << tile.x << "," << tile.y;
            }
        }
    }
}

class RasterLight : public RasterTest {
  protected:
    // A mirror, glass and plain surfaces under a lamp and a lit pane, with a sky.
    void SetUp() override {
        RasterTest::SetUp();
        scene::Material mirror, glass, lit;
        mirror.metallic = 1.0f;
        mirror.roughness = 0.0f;
        glass.transmission = 1.0f;
        glass.thickness = 1.0f;
        glass.roughness = 0.0f;
        lit.emission = glm::vec3(3.0f);
        lit.double_sided = true;
        place(square(6.0), glm::rotate(moved(0, -1, -4), -1.5707963, glm::dvec3(1, 0, 0)));
        place(sphere(0.7, 12, material(mirror)), moved(-0.9, -0.3, -3));
        place(sphere(0.7, 12, material(glass)), moved(0.9, -0.3, -3));
        place(square(0.5, material(lit)), glm::rotate(moved(0, 1.5, -3), 1.5, glm::dvec3(1, 0, 0)));
        light({1, 2, -1}, 6.0f);
        build();
    }
};

// Batches of samples of the whole picture: all pixels of a sample share a subpixel position, so they are not
// independent estimates, but the means of samples are.
TEST_F(RasterLight, MatchesWhitted) {
    view::View raster = view_from({}, 48, 32);
    raster.channels.insert(frame::Channel::Albedo);
    raster.channels.insert(frame::Channel::Normal);
    raster.channels.insert(frame::Channel::Alpha);
    view::View whitted = raster;
    whitted.renderer = view::Renderer::Whitted;
    constexpr std::uint64_t Batches = 24;
    constexpr std::array Channels{frame::Channel::Radiance, frame::Channel::Albedo, frame::Channel::Normal,
                                  frame::Channel::Alpha};
    struct Sums {
        double difference = 0, squares = 0, size = 0;
    };
    std::array<Sums, Channels.size()> sums;
    for (std::uint64_t batch = 0; batch < Batches; ++batch) {
        const frame::FilmTile drawn = film(raster, {8 * batch, 3}), traced = film(whitted, {8 * batch, 3});
        for (std::size_t i = 0; i < Channels.size(); ++i) {
            const auto mean = [&](const frame::FilmTile& film) {
                const frame::Image image = frame::resolve(film, Channels[i]);
                double total = 0;
                for (const float value : image.values) total += double(value);
                return total / double(image.values.size());
            };
            const double difference = mean(drawn) - mean(traced);
            sums[i].difference += difference;
            sums[i].squares += difference * difference;
            sums[i].size += std::fabs(mean(traced));
        }
    }
    for (std::size_t i = 0; i < Channels.size(); ++i) {
        const double bias = sums[i].difference / Batches, size = sums[i].size / Batches;
        const double error = std::sqrt((sums[i].squares / Batches - bias * bias) / (Batches - 1));
        EXPECT_LE(std::fabs(bias), 4.0 * error + 1e-6 * size) << frame::info(Channels[i]).name;
        EXPECT_LE(error, 0.02 * size) << frame::info(Channels[i]).name;
    }
}

// Inside surfaces, where nothing changes within a pixel, sample by sample: the seeds are the
// pixel's own, so only the subpixel position differs.
TEST_F(RasterLight, MatchesWhittedSampleBySample) {
    view::View raster = view_from({}, 48, 32);
    raster.pixel_filter = {view::PixelFilterKind::Box, 1e-4f};  // as good as the pixel's centre, for both
    view::View whitted = raster;
    whitted.renderer = view::Renderer::Whitted;
    std::size_t agree = 0, count = 0;
    for (std::uint64_t index = 0; index < 8; ++index) {
        const frame::Image a = frame::resolve(film(raster, {index, 0}), frame::Channel::Radiance);
        const frame::Image b = frame::resolve(film(whitted, {index, 0}), frame::Channel::Radiance);
        for (std::size_t i = 0; i < a.values.size(); ++i) {
            ++count;
            agree += std::fabs(a.values[i] - b.values[i]) <= 0.01f * (0.1f + b.values[i]) ? 1 : 0;
        }
    }
    EXPECT_GE(double(agree), 0.98 * double(count));
}

TEST_F(RasterLight, SwitchesRenderersWithTheView) {
    view::View view = view_from({}, 48, 32);
    const Version version = adapter_->version();
    const frame::FilmTile drawn = film(view, {0, 2});
    view.renderer = view::Renderer::PathTracing;
    view.revision = 2;
    const frame::FilmTile traced = film(view, {0, 2});
    EXPECT_FALSE(frame::identical_bits(drawn, traced));
    view.renderer = view::Renderer::Raster;
    view.revision = 3;
    EXPECT_TRUE(frame::identical_bits(drawn, film(view, {0, 2})));
    EXPECT_EQ(adapter_->version(), version);
}

TEST_F(RasterLight, BlocksMatchTheirSamples) {
    const view::View view = view_from({}, 48, 32);
    const frame::FilmTile eight = film(view, {8, 3});
    frame::FilmTile left = film(view, {8, 2});
    frame::merge(left, film(view, {12, 2}));
    EXPECT_TRUE(frame::identical_bits(eight, left));
}

}  // namespace
}  // namespace tessera::vulkan
