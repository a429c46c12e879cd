// Light samples of the sky where it is seen: the same mean, less noise, densities that fit the samples.
#include "mediator/shading/sky_cells.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <stop_token>

#include "mediator/backend/sky_cells.h"
#include "mediator/shading/lights.h"
#include "tests/statistics/model.h"
#include "tests/statistics/room.h"

namespace tessera::embree {
namespace {

using backend::SkyCells;
using shading::SkyTiles;
using test::inside_room;

struct Room : Model {
    explicit Room(double scale = 1.0, glm::dvec3 origin = glm::dvec3(0.0), bool has_window = true)
        : Model(origin) {
        set_frame(glm::scale(glm::translate(glm::dmat4(1.0), origin), glm::dvec3(scale)));
        test::add_room(*this, has_window);
    }
    void sky_with_sun(float sun) { test::add_sky_with_sun(*this, sun); }
};

struct Noise {
    double mean = 0.0, standard_error = 0.0;
    double variance = 0.0;  // of a sample in its pixel, mean of all pixels
};

Noise noise_of(const PathTracer& tracer, std::uint64_t spp, std::uint64_t first = 0) {
    Noise noise;
    std::uint64_t rays = 0;
    const double pixels = double(tracer.view().width) * tracer.view().height;
    for (std::uint32_t y = 0; y < tracer.view().height; ++y) {
        for (std::uint32_t x = 0; x < tracer.view().width; ++x) {
            double sum = 0.0, squares = 0.0;
            for (std::uint64_t sample = first; sample < first + spp; ++sample) {
                const double value = red(tracer.trace(x, y, sample, rays));
                sum += value;
                squares += value * value;
            }
            noise.mean += sum / double(spp) / pixels;
            noise.variance += (squares - sum * sum / double(spp)) / double(spp - 1) / pixels;
        }
    }
    noise.standard_error = std::sqrt(noise.variance / double(spp) / pixels);
    return noise;
}

SkyCells cells_of(const PathTracer& tracer, std::uint32_t threads = 1) {
    const auto made = tracer.make_sky_cells(threads, {});
    EXPECT_TRUE(made);
    return made.value_or(SkyCells{});
}

struct Compared {
    Noise plain, guided;
    SkyCells cells;
};
Compared with_and_without_cells(const SceneAdapter& world, const view::View& view, std::uint64_t spp) {
    PathTracer tracer(world.tables(), world.scene(), view);
    Compared found{.plain = noise_of(tracer, spp), .guided = {}, .cells = cells_of(tracer)};
    EXPECT_FALSE(found.cells.empty());
    tracer.use_sky_cells(found.cells, 0);
    found.guided = noise_of(tracer, spp);
    return found;
}

Compared compared(const SceneAdapter& world, const view::View& view, std::uint64_t spp) {
    Compared found = with_and_without_cells(world, view, spp);
    EXPECT_GT(found.cells.visible, 0.0);
    EXPECT_LT(found.cells.visible, 0.2);
    return found;
}

void expect_same_mean(const Compared& found) {
    EXPECT_NEAR(found.guided.mean, found.plain.mean,
                4.0 * std::hypot(found.guided.standard_error, found.plain.standard_error));
}

TEST(SkyCells, KeepTheLightOfAnEvenSkyAndHaveLessNoise) {
    Room room;
    room.sky(glm::vec3(1.0f));
    const Compared found = compared(room.build(), inside_room(), 512);
    expect_same_mean(found);
    EXPECT_LT(found.guided.variance, found.plain.variance / 3.0);
}

TEST(SkyCells, KeepTheLightOfASunAndHaveLessNoise) {
    Room room;
    room.sky_with_sun(200.0f);
    const Compared found = compared(room.build(), inside_room(), 512);
    expect_same_mean(found);
    EXPECT_LT(found.guided.variance, found.plain.variance / 2.0);
}

TEST(SkyCells, KeepTheLightOfLampsAndOfAPane) {
    Room room;
    room.sky(glm::vec3(1.0f));
    room.floor(room.material(lamp(4.0f)), -0.2f, 2.9f);
    room.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(0.5f), .angle = 0.05f},
               glm::rotate(glm::dmat4(1.0), 1.2, {0.0, 1.0, 0.0}));
    scene::Material pane = glass(1.5f, glm::vec3(0.9f));
    pane.thickness = 0.0f;
    room.quad(room.material(pane), {{{2, -0.5f, 1}, {2, -0.5f, 2}, {2, 0.5f, 2}, {2, 0.5f, 1}}});
    expect_same_mean(compared(room.build(), inside_room(), 512));
}

// A sun that shines through the window, or, turned the other way, on the wall outside.
void add_sun(Room& room, float intensity, double turn, float angle = 0.01f) {
    room.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(intensity), .angle = angle},
               glm::rotate(glm::dmat4(1.0), turn, {0.0, 1.0, 0.0}));
}
constexpr double ThroughWindow = 1.2, OnOuterWall = -1.2;

double greatest_share_of_suns(const SkyCells& cells) {
    double greatest = 0.0;
    for (const shading::SkyCell& cell : cells.cells) greatest = std::max(greatest, double(cell.suns));
    return greatest;
}

// A room under an even sky and a sun.
Compared compared_under_sun(double turn) {
    Room room;
    room.sky(glm::vec3(1.0f));
    add_sun(room, 20.0f, turn);
    Compared found = compared(room.build(), inside_room(), 512);
    expect_same_mean(found);
    return found;
}

TEST(SunsInSkyCells, TakeFewSamplesFromTheSkyWhereTheyAreHidden) {
    const Compared found = compared_under_sun(OnOuterWall);
    EXPECT_LT(found.guided.variance, found.plain.variance / 8.0);
    EXPECT_EQ(found.cells.visible_suns, 0.0);
    // Of cells that it does not face, nothing is known.
    EXPECT_LE(greatest_share_of_suns(found.cells), 0.5);
}

TEST(SunsInSkyCells, AreSampledWhereTheyShine) {
    const Compared found = compared_under_sun(ThroughWindow);
    EXPECT_LT(found.guided.variance, found.plain.variance);
    EXPECT_GT(found.cells.visible_suns, 0.0);
    EXPECT_LT(found.cells.visible_suns, 0.2);
    EXPECT_GT(greatest_share_of_suns(found.cells), 0.8);
}

TEST(SunsInSkyCells, NeedNoSky) {
    Room room;
    room.point_light({0.0, 0.0, 1.5}, 1.0f);
    add_sun(room, 20.0f, OnOuterWall, 0.0f);
    const Compared found = with_and_without_cells(room.build(), inside_room(), 512);
    expect_same_mean(found);
    EXPECT_LT(found.guided.variance, found.plain.variance / 2.5);
}

// The only light is sampled anyway; one that the view does not see is not.
TEST(SunsInSkyCells, AreLeftOutWhereThereIsNoChoice) {
    Room room;
    add_sun(room, 20.0f, OnOuterWall);
    const SceneAdapter& world = room.build();
    EXPECT_TRUE(cells_of(PathTracer(world.tables(), world.scene(), inside_room())).empty());
    Room lamps;
    lamps.floor(lamps.material(lamp(4.0f)), -0.2f, 2.9f);
    lamps.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(20.0f)},
                glm::rotate(glm::dmat4(1.0), OnOuterWall, {0.0, 1.0, 0.0}), 2);
    const SceneAdapter& lit = lamps.build();
    view::View view = inside_room();
    view.layers = ~2u;
    EXPECT_TRUE(cells_of(PathTracer(lit.tables(), lit.scene(), view)).empty());
}

// What a view that is not yet at rest does: the first samples are those of a view without cells.
TEST(SkyCells, ChangeNoBitOfSamplesBeforeTheirFirst) {
    Room room;
    room.sky_with_sun(50.0f);
    const SceneAdapter& world = room.build();
    PathTracer plain(world.tables(), world.scene(), inside_room()),
        guided(world.tables(), world.scene(), inside_room());
    const SkyCells cells = cells_of(plain);
    guided.use_sky_cells(cells, 8);
    std::uint64_t rays = 0;
    int changed = 0;
    for (std::uint64_t sample = 0; sample < 16; ++sample) {
        for (std::uint32_t x = 0; x < 16; ++x) {
            const glm::vec3 before = radiance_of(plain.trace(x, 8, sample, rays)),
                            after = radiance_of(guided.trace(x, 8, sample, rays));
            if (before != after) changed += sample < 8 ? 1000 : 1;
        }
    }
    EXPECT_GT(changed, 32);
    EXPECT_LT(changed, 1000);
}

bool same_bits(const SkyCells& a, const SkyCells& b) {
    const auto same = [](const auto& x, const auto& y) {
        return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
    };
    return same(a.nodes, b.nodes) && same(a.cells, b.cells) && same(a.cdfs, b.cdfs);
}

TEST(SkyCells, AreTheSameForAnyNumberOfThreads) {
    Room room;
    room.sky_with_sun(50.0f);
    const SceneAdapter& world = room.build();
    const PathTracer tracer(world.tables(), world.scene(), inside_room());
    const SkyCells one = cells_of(tracer, 1);
    ASSERT_FALSE(one.empty());
    EXPECT_TRUE(same_bits(one, cells_of(tracer, 2)));
    EXPECT_TRUE(same_bits(one, cells_of(tracer, 3)));
}

TEST(SkyCells, StopWhenAsked) {
    Room room;
    room.sky(glm::vec3(1.0f));
    const SceneAdapter& world = room.build();
    std::stop_source source;
    source.request_stop();
    EXPECT_FALSE(
        PathTracer(world.tables(), world.scene(), inside_room()).make_sky_cells(1, source.get_token()));
}

TEST(SkyCells, AreLeftOutWhereTheSkyIsSeenOrDark) {
    Model field;
    field.floor(field.material(chalk(glm::vec3(0.6f))), 100.0f, 0.0f);
    field.sky(glm::vec3(1.0f));
    const SceneAdapter& open = field.build();
    const SkyCells seen = cells_of(PathTracer(open.tables(), open.scene(), inside_room()));
    EXPECT_TRUE(seen.empty());
    EXPECT_GT(seen.visible, 0.9);
    Room dark;
    const SceneAdapter& black = dark.build();
    EXPECT_TRUE(cells_of(PathTracer(black.tables(), black.scene(), inside_room())).empty());
}

// No light arrives: nothing to learn, and no NaN.
TEST(SkyCells, OfAClosedRoomAreBlackAndFinite) {
    Room room(1.0, glm::dvec3(0.0), false);
    room.sky_with_sun(1e9f);
    const SceneAdapter& world = room.build();
    PathTracer tracer(world.tables(), world.scene(), inside_room());
    const SkyCells cells = cells_of(tracer);
    EXPECT_EQ(cells.visible, 0.0);
    tracer.use_sky_cells(cells, 0);
    EXPECT_EQ(noise_of(tracer, 16).mean, 0.0);
}

// Directions of samples have the density that the other technique assumes.
TEST(SkyCells, SampleDirectionsWithTheirDensities) {
    Room room;
    room.sky_with_sun(50.0f);
    const SceneAdapter& world = room.build();
    PathTracer tracer(world.tables(), world.scene(), inside_room());
    const SkyCells cells = cells_of(tracer);
    ASSERT_FALSE(cells.empty());
    tracer.use_sky_cells(cells, 0);
    const shading::Scene scene = backend::on_host(world.tables());
    constexpr std::uint32_t Side = 512;
    for (const std::uint32_t cell :
         {0u, std::uint32_t(cells.cells.size() / 2), std::uint32_t(cells.cells.size() - 1)}) {
        std::array<double, SkyTiles> observed{}, expected{};
        for (std::uint32_t i = 0; i < Side * Side; ++i) {
            const glm::vec2 u = (glm::vec2(float(i % Side), float(i / Side)) + 0.5f) / float(Side);
            const glm::vec3 direction = shading::sample_visible_sky(scene, tracer.view(), cell, u);
            EXPECT_NEAR(glm::length(direction), 1.0f, 1e-6f);
            observed[shading::sky_tile_of(direction)] += 1.0 / (Side * Side);
        }
        // The map's density by its texels, which are smaller than tiles.
        for (std::uint32_t tile = 0; tile < SkyTiles; ++tile) {
            constexpr std::uint32_t Parts = 32;
            for (std::uint32_t i = 0; i < Parts * Parts; ++i) {
                const glm::vec2 u = (glm::vec2(float(i % Parts), float(i / Parts)) + 0.5f) / float(Parts);
                const glm::vec3 direction = shading::direction_in_tile(tile, u);
                const float pdf = shading::sky_cell_pdf(tracer.view(), cell, direction,
                                                        shading::sky_at(scene, direction).pdf);
                expected[tile] += double(pdf) * double(shading::SkyTileSolidAngle) / (Parts * Parts);
            }
        }
        double sum = 0.0;
        for (std::uint32_t tile = 0; tile < SkyTiles; ++tile) {
            EXPECT_NEAR(observed[tile], expected[tile], 2e-3 + 0.03 * expected[tile]) << cell << " " << tile;
            sum += expected[tile];
        }
        EXPECT_NEAR(sum, 1.0, 5e-3) << cell;
    }
}

TEST(SkyCellsNumerics, TilesHoldTheirDirections) {
    for (std::uint32_t tile = 0; tile < SkyTiles; ++tile) {
        for (const glm::vec2 u : {glm::vec2(0.5f), glm::vec2(0.01f, 0.99f), glm::vec2(0.99f, 0.01f)}) {
            const glm::vec3 direction = shading::direction_in_tile(tile, u);
            EXPECT_EQ(shading::sky_tile_of(direction), tile);
            EXPECT_NEAR(glm::length(direction), 1.0f, 1e-6f);
        }
        // On the edges: some tile, never beyond the last.
        for (const glm::vec2 u : {glm::vec2(0.0f), glm::vec2(0.99999994f)})
            EXPECT_LT(shading::sky_tile_of(shading::direction_in_tile(tile, u)), SkyTiles);
    }
    for (const glm::vec3 pole :
         {glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(-1, -0.0f, 0), glm::vec3(0.0f)})
        EXPECT_LT(shading::sky_tile_of(pole), SkyTiles);
}

// Cells are in the units of the scene: any scale and place has the same picture.
TEST(SkyCellsNumerics, DoNotDependOnScaleOrPlace) {
    Room room;
    room.sky(glm::vec3(1.0f));
    const Noise expected = compared(room.build(), inside_room(), 128).guided;
    for (const double scale : {1e-6, 1e6}) {
        Room other(scale);
        other.sky(glm::vec3(1.0f));
        const Compared found = compared(other.build(), inside_room(scale), 128);
        EXPECT_NEAR(found.guided.mean, expected.mean,
                    4.0 * std::hypot(expected.standard_error, found.guided.standard_error));
        EXPECT_NEAR(found.guided.variance, expected.variance, 0.5 * expected.variance) << scale;
    }
    const glm::dvec3 far(1e7, -1e7, 3e6);
    Room moved(1.0, far);
    moved.sky(glm::vec3(1.0f));
    const Compared found = compared(moved.build(), inside_room(1.0, far), 128);
    EXPECT_NEAR(found.guided.mean, expected.mean,
                4.0 * std::hypot(expected.standard_error, found.guided.standard_error));
}

// Damaged and extreme maps: cells stay finite, and so do samples.
TEST(SkyCellsNumerics, AreFiniteUnderAnySky) {
    constexpr float Inf = std::numeric_limits<float>::infinity(),
                    Nan = std::numeric_limits<float>::quiet_NaN();
    for (const float sun : {0.0f, 1e-38f, 1e9f, 3e38f, -5.0f, Inf, Nan}) {
        Room room;
        room.sky_with_sun(sun);
        add_sun(room, std::isfinite(sun) && sun > 0.0f ? sun : 1.0f, ThroughWindow);
        const SceneAdapter& world = room.build();
        const SkyCells cells = cells_of(PathTracer(world.tables(), world.scene(), inside_room()));
        for (const float value : cells.cdfs) ASSERT_TRUE(value >= 0.0f && value <= 1.0f) << sun;
        for (const shading::SkyCell& cell : cells.cells) {
            ASSERT_TRUE(std::isfinite(cell.irradiance) && cell.irradiance >= 0.0f) << sun;
            ASSERT_TRUE(cell.tile_chance >= 0.0f && cell.tile_chance <= 1.0f) << sun;
            ASSERT_TRUE(cell.suns > 0.0f && cell.suns < 1.0f) << sun;
        }
    }
}

}  // namespace
}  // namespace tessera::embree
