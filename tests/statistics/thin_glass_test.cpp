// Light through thin walls of clear glass, which connections to lights pass: closed forms, and the strategies against
// each other.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mediator/shading/fresnel.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

constexpr float Albedo = 0.6f, Index = 1.5f;
constexpr double SunLight = 3.0;

scene::Material pane(const glm::vec3& color = glm::vec3(1.0f)) {
    scene::Material material = glass(Index, color);
    material.thickness = 0.0f;
    return material;
}

double transmittance(double cosine) {
    return 1.0 - double(shading::fresnel_dielectric(static_cast<float>(cosine), Index));
}

// Down onto the floor, from below all panes: all pixels see one place.
view::View onto_floor() {
    view::View view = small_view({0.0, 0.0, 0.5}, 1e-3);
    view.max_bounces = 0;
    return view;
}

// A floor, and what is added.
struct PanedRoom : Model {
    explicit PanedRoom(float albedo = Albedo, float height = 0.0f) {
        floor(material(chalk(glm::vec3(albedo))), 100.0f, height);
    }
    // Shines down, tilted from the vertical.
    void sun(double tilt, float half_angle = 0.0f) {
        light({.kind = scene::LightKind::Directional,
               .intensity = glm::vec3(static_cast<float>(SunLight)),
               .angle = half_angle},
              glm::rotate(glm::dmat4(1.0), tilt, {1.0, 0.0, 0.0}));
    }
    SceneAdapter& world() {
        if (world_ == nullptr) world_ = &build();
        return *world_;
    }
    Mean light(std::uint64_t spp, Strategy strategy = Strategy::Both, const view::View& view = onto_floor()) {
        const PathTracer tracer(world().tables(), world().scene(), view, strategy);
        const std::uint64_t pixels = std::uint64_t{view.width} * view.height;
        double sum = 0, squares = 0;
        rays = 0;
        for (std::uint64_t i = 0; i < spp * pixels; ++i) {
            const auto pixel = static_cast<std::uint32_t>(i % pixels);
            const double value = red(tracer.trace(pixel % view.width, pixel / view.width, i / pixels, rays));
            sum += value;
            squares += value * value;
        }
        const double n = static_cast<double>(spp * pixels), mean = sum / n;
        return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / n)};
    }
    using Model::light;

    std::uint64_t rays = 0;  // of the last light()

  private:
    SceneAdapter* world_ = nullptr;
};

void expect_value(const Mean& mean, double expected) {
    EXPECT_NEAR(mean.value, expected, 4.0 * mean.standard_error + 1e-5 * expected);
    EXPECT_LE(mean.standard_error, 0.01 * expected);
}

void expect_equal(const Mean& a, const Mean& b) {
    EXPECT_NEAR(a.value, b.value, 4.0 * std::hypot(a.standard_error, b.standard_error) + 1e-5 * b.value);
}

class PanesInTheSun : public testing::TestWithParam<double> {};

TEST_P(PanesInTheSun, PassTheirTransmittanceEach) {
    const double tilt = GetParam(), cosine = std::cos(tilt);
    const double open = Albedo / M_PI * SunLight * cosine;
    for (const int count : {1, 2, 7, 20}) {
        PanedRoom room;
        const ObjectId tinted = room.material(pane(glm::vec3(0.9f)));
        for (int i = 0; i < count; ++i)
            room.floor(tinted, i % 2 == 0 ? 90.0f : -90.0f, 1.0f + 0.1f * static_cast<float>(i));
        room.sun(tilt);
        expect_value(room.light(1), open * std::pow(double(0.9f) * transmittance(cosine), count));
    }
}

INSTANTIATE_TEST_SUITE_P(Tilts, PanesInTheSun, testing::Values(0.0, 0.6, 1.2, 1.5));

// Two panes an eighth of their height apart, in rooms of a tenth of a millimetre to a hundred kilometres, and far from the
// origin, where positions have errors of millimetres.
TEST(ThinGlass, PassesLightAtAnyScaleAndFarAway) {
    for (const float size : {1e-4f, 1.0f, 1e5f}) {
        for (const float away : {0.0f, 1e4f}) {
            PanedRoom room(Albedo, away * size);
            const ObjectId clear = room.material(pane());
            for (const float z : {1.0f, 1.125f}) room.floor(clear, 90.0f * size, (away + z) * size);
            room.sun(0.5);
            view::View view = small_view({0.0, 0.0, double((away + 0.5f) * size)}, 1e-3);
            view.max_bounces = 0;
            const double expected =
                Albedo / M_PI * SunLight * std::cos(0.5) * std::pow(transmittance(std::cos(0.5)), 2);
            EXPECT_NEAR(room.light(1, Strategy::Both, view).value, expected, 1e-4 * expected)
                << size << " " << away;
        }
    }
}

// A shadow ray looks through two walls itself, and is traced from wall to wall through more. What the floor scatters takes
// a ray for each wall as well, and more if it is reflected between them.
TEST(ThinGlass, TwoPanesCostNoRays) {
    constexpr std::uint64_t Samples = 16 * 16;
    for (const std::uint64_t count : {0, 1, 2, 3, 5}) {
        PanedRoom room;
        const ObjectId tinted = room.material(pane(glm::vec3(0.9f)));
        for (std::uint64_t i = 0; i < count; ++i)
            room.floor(tinted, 90.0f, 1.0f + 0.1f * static_cast<float>(i));
        room.sun(0.3);
        room.light(1);
        const std::uint64_t without_walls = 3 * Samples, scattered = 2 * count * Samples;
        EXPECT_GE(room.rays, without_walls + (count <= 2 ? 0 : count * Samples));
        EXPECT_LE(room.rays, without_walls + scattered + (count <= 2 ? 0 : (count + 1) * Samples));
    }
}

TEST(ThinGlass, ALampShinesThroughItsBulb) {
    PanedRoom room;
    room.sphere(room.material(pane()), {0.0, 0.0, 2.0}, 0.2, Normals::Smooth);
    room.point_light({0.0, 0.0, 2.0}, 50.0f);
    // The smallest circle around the pole is flat.
    expect_value(room.light(1), Albedo / M_PI * 50.0 / 4.0 * transmittance(1.0));
}

// Light that both techniques find: every strategy has the same mean.
struct PanedSource {
    const char* name;
    void (*add)(PanedRoom& room);
};

const PanedSource PanedSources[] = {
    {"lamp", [](PanedRoom& room) { room.floor(room.material(lamp(5.0f)), -1.0f, 3.0f); }},
    {"sphere",
     [](PanedRoom& room) {
         room.light({.kind = scene::LightKind::Sphere, .intensity = glm::vec3(5.0f), .radius = 0.7f},
                    glm::translate(glm::dmat4(1.0), {0.3, 0.0, 2.5}));
     }},
    {"quad",
     [](PanedRoom& room) {
         room.light({.kind = scene::LightKind::Quad, .intensity = glm::vec3(5.0f), .size = {1.5f, 1.0f}},
                    glm::translate(glm::dmat4(1.0), {0.3, 0.0, 2.5}));
     }},
    {"sky", [](PanedRoom& room) { room.sky(glm::vec3(2.0f)); }},
    {"sun with an angle", [](PanedRoom& room) { room.sun(0.4, 0.3f); }}};

struct Panes {
    const char* name;
    void (*add)(PanedRoom& room);
};

void hang(PanedRoom& room, const scene::Material& material, float z = 1.2f) {
    room.floor(room.material(material), 90.0f, z);
}

const Panes PanesOf[] = {{"clear", [](PanedRoom& room) { hang(room, pane()); }},
                         {"three",
                          [](PanedRoom& room) {
                              for (const float z : {1.0f, 1.2f, 1.25f}) hang(room, pane(glm::vec3(0.8f)), z);
                          }},
                         {"half diffuse",
                          [](PanedRoom& room) {
                              scene::Material half = pane(glm::vec3(0.8f));
                              half.transmission = 0.5f;
                              half.double_sided = true;
                              hang(room, half);
                          }},
                         {"coated",
                          [](PanedRoom& room) {
                              scene::Material coated = pane();
                              coated.clearcoat = 1.0f;
                              coated.clearcoat_roughness = 0.3f;
                              hang(room, coated);
                          }},
                         {"film",
                          [](PanedRoom& room) {
                              scene::Material film = pane();
                              film.iridescence = 1.0f;
                              hang(room, film);
                          }},
                         {"behind a sheet of alpha 0.4", [](PanedRoom& room) {
                              scene::Material sheet = chalk(glm::vec3(0.0f));
                              sheet.base_color.w = 0.4f;
                              sheet.alpha_mode = scene::AlphaMode::Blend;
                              hang(room, sheet, 1.1f);
                              hang(room, pane());
                              hang(room, sheet, 1.3f);
                          }}};

class ThinGlassStrategies : public testing::TestWithParam<std::tuple<PanedSource, Panes>> {};

TEST_P(ThinGlassStrategies, Agree) {
    const auto& [source, wall] = GetParam();
    PanedRoom room;
    source.add(room);
    wall.add(room);
    const Mean lights = room.light(256, Strategy::LightsOnly);
    EXPECT_GT(lights.value, 0.0);
    expect_equal(room.light(256, Strategy::Both), lights);
    expect_equal(room.light(1024, Strategy::BsdfOnly), lights);
    // Whitted finds what comes straight, not what is reflected between panes: 2 % of a sky behind three.
    view::View straight = onto_floor(), whitted = onto_floor();
    straight.max_specular_bounces = 0;
    whitted.renderer = view::Renderer::Whitted;
    expect_equal(room.light(256, Strategy::Both, whitted), room.light(256, Strategy::Both, straight));
}

INSTANTIATE_TEST_SUITE_P(All, ThinGlassStrategies,
                         testing::Combine(testing::ValuesIn(PanedSources), testing::ValuesIn(PanesOf)));

// Straight through is no bounce, whatever finds the light.
TEST(ThinGlass, PanesAreNoBounces) {
    PanedRoom room;
    constexpr int Count = 12;
    for (int i = 0; i < Count; ++i) hang(room, pane(), 1.0f + 0.1f * static_cast<float>(i));
    room.sky(glm::vec3(1.0f));
    const Mean lights = room.light(256, Strategy::LightsOnly);
    EXPECT_GT(lights.value, 0.3 * double(Albedo));
    expect_equal(room.light(4096, Strategy::BsdfOnly), lights);
    expect_equal(room.light(1024, Strategy::Both), lights);
}

// With all bounces, white things behind a pane in a white furnace are as white as in the open.
TEST(ThinGlass, AFurnaceStaysWhite) {
    for (const Strategy strategy : {Strategy::Both, Strategy::LightsOnly, Strategy::BsdfOnly}) {
        PanedRoom room(1.0f);
        room.sphere(room.material(pane()), {0.0, 0.0, 3.0}, 1.0);
        room.sphere(room.material(chalk(glm::vec3(1.0f))), {0.0, 0.0, 3.0}, 0.6);
        room.sky(glm::vec3(1.0f));
        const Mean mean = room.light(256, strategy, small_view({0.0, 0.0, 8.0}, 0.1));
        EXPECT_NEAR(mean.value, 1.0, 4.0 * mean.standard_error + 2e-4) << int(strategy);
    }
}

// Fog on both sides of a pane takes its part of a connection, segment by segment.
TEST(ThinGlass, AttenuatesWithTheFogAroundIt) {
    PanedRoom room;
    room.set_medium({.absorption = glm::vec3(0.3f)});
    room.box({}, {-50.0f, -50.0f, -1.0f}, {50.0f, 50.0f, 4.0f});
    room.clear_medium();
    hang(room, pane());
    room.sun(0.0);
    const Mean mean = room.light(4);
    expect_value(mean, Albedo / M_PI * SunLight * transmittance(1.0) * std::exp(-0.3 * (4.0 + 0.5)));
}

// Rough thin glass scatters: connections end there.
TEST(ThinGlass, RoughPanesHideADirectionalLight) {
    PanedRoom room;
    scene::Material frosted = pane();
    frosted.roughness = 0.5f;
    hang(room, frosted);
    room.sun(0.0);
    EXPECT_EQ(room.light(4).value, 0.0);
}

}  // namespace
}  // namespace tessera::embree
