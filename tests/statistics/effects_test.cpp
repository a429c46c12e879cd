// LT31: every effect that Lardinoije's table 1.1 asks of a picture, each in a scene of few surfaces.
#include <gtest/gtest.h>

#include <vector>

#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

// Means of the pixels, row by row.
std::vector<glm::dvec3> effect_picture(const SceneAdapter& world, const view::View& view, std::uint64_t spp) {
    std::vector<glm::dvec3> pixels(std::size_t{view.width} * view.height);
    std::size_t i = 0;
    for_samples(world, view, spp, [&](const PathSample& sample) {
        pixels[i++ % pixels.size()] += glm::dvec3(radiance_of(sample)) / double(spp);
    });
    return pixels;
}

glm::dvec3 mean_light(const SceneAdapter& world, const view::View& view, std::uint64_t spp) {
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& pixel : effect_picture(world, view, spp)) sum += pixel;
    return sum / double(view.width * view.height);
}

// A point of the floor z = 0, from above.
view::View floor_at(double x, std::uint32_t max_bounces = view::UnlimitedBounces) {
    view::View view = small_view({x, 0.0, 0.3}, 1e-3, 4);
    view.max_bounces = max_bounces;
    return view;
}

scene::Light sun(float irradiance) {
    return {.kind = scene::LightKind::Directional, .intensity = glm::vec3(irradiance)};
}

// A white floor, and a wall along y at x = 1, of height 2.
struct WalledFloor : Model {
    explicit WalledFloor(const glm::vec3& wall) {
        floor(material(chalk(glm::vec3(0.8f))), 4.0f, 0.0f);
        quad(material(chalk(wall)), {{{1, -4, 0}, {1, -4, 2}, {1, 4, 2}, {1, 4, 0}}});
    }
};

TEST(Effects, IndirectLightReachesWhatNoLightDoes) {
    // The sun comes over the wall from the right, and lights the floor to the left of x = -1 only.
    WalledFloor corner(glm::vec3(0.8f));
    corner.light(sun(3.0f), glm::rotate(glm::dmat4(1.0), M_PI / 4.0, {0.0, 1.0, 0.0}));
    const SceneAdapter& world = corner.build();
    EXPECT_NEAR(mean_light(world, floor_at(-2.0, 0), 16).x, 0.8 / M_PI * 3.0 * std::sqrt(0.5), 1e-4);
    // From the lit floor to the wall, and back to the floor in the wall's shadow.
    for (const double x : {0.0, 0.9}) {
        EXPECT_EQ(mean_light(world, floor_at(x, 0), 16).x, 0.0);
        EXPECT_EQ(mean_light(world, floor_at(x, 1), 256).x, 0.0);
        EXPECT_GT(mean_light(world, floor_at(x, 2), 256).x, 0.004);
    }
}

TEST(Effects, ColoursBleed) {
    WalledFloor corner({0.8f, 0.05f, 0.05f});
    corner.light(sun(3.0f), glm::rotate(glm::dmat4(1.0), -M_PI / 4.0, {0.0, 1.0, 0.0}));  // onto the wall
    const SceneAdapter& world = corner.build();
    const glm::dvec3 direct = mean_light(world, floor_at(0.8, 0), 16);
    const glm::dvec3 near = mean_light(world, floor_at(0.8), 1024),
                     far = mean_light(world, floor_at(-3.0), 1024);
    ASSERT_GT(direct.x, 0.1);
    EXPECT_EQ(direct.x, direct.y);
    EXPECT_GT(near.x / near.y, 1.05);
    EXPECT_GT(far.x / far.y, 1.0);
    EXPECT_LT(far.x / far.y, 0.5 * (1.0 + near.x / near.y));
    EXPECT_NEAR(near.y / near.z, 1.0, 1e-6);
}

// A closed white room under the brightest sky and sun, seen from its middle in all directions.
void expect_a_dark_room(const glm::dvec3& place, double turn) {
    Model model(place);
    model.set_frame(
        glm::rotate(glm::translate(glm::dmat4(1.0), place), turn, glm::normalize(glm::dvec3(1.0, 2.0, 0.5))));
    model.box(model.material(chalk(glm::vec3(0.9f))), glm::vec3(-1.0f), glm::vec3(1.0f));
    model.sky(glm::vec3(1e6f));
    model.light(sun(1e6f), glm::dmat4(1.0));
    const SceneAdapter& world = model.build();
    for (const double yaw : {0.0, 0.9, 2.5, 4.0}) {
        const view::View view =
            small_view(place, 1.6, 32, glm::rotate(glm::dmat4(1.0), yaw, {0.5, 1.0, 0.0}));
        for_samples(world, view, 4, [&](const PathSample& sample) {
            ASSERT_EQ(radiance_of(sample), glm::vec3(0.0f)) << place.y << " " << turn << " " << yaw;
        });
    }
}

TEST(Effects, NoLightLeaksThroughEdges) {
    for (const double turn : {0.0, 0.6}) {
        for (const double height : {0.0, 1e6}) expect_a_dark_room({0.3, height, -0.7}, turn);
    }
}

TEST(Effects, ContactsAreDarker) {
    // A long black wall hides (1 - d / sqrt(d^2 + h^2)) / 2 of an even sky's light at a distance d.
    Model model;
    model.floor(model.material(chalk(glm::vec3(0.5f))), 1e3f, 0.0f);
    model.quad(model.material(chalk(glm::vec3(0.0f))),
               {{{0, -1e3, 0}, {0, -1e3, 2}, {0, 1e3, 2}, {0, 1e3, 0}}});
    model.sky(glm::vec3(1.0f));
    const SceneAdapter& world = model.build();
    double last = 0.0;
    for (const double d : {0.02, 0.5, 2.0, 8.0}) {
        const double light = mean_light(world, floor_at(-d, 0), 1024).x;
        EXPECT_NEAR(light, 0.5 * (1.0 - 0.5 * (1.0 - d / std::hypot(d, 2.0))), 0.004) << d;
        EXPECT_GT(light, last);
        last = light;
    }
}

// The distance from 10 to 90 % of the light across the shadow of an edge halfway up to a square light of this size.
double penumbra_width(float size) {
    constexpr float Edge = 1.0f, Height = 2.0f;
    constexpr std::uint32_t Pixels = 64;
    Model model;
    model.floor(model.material(chalk(glm::vec3(0.8f))), 10.0f, 0.0f);
    model.quad(model.material(chalk(glm::vec3(0.0f))),
               {{{0, -10, Edge}, {10, -10, Edge}, {10, 10, Edge}, {0, 10, Edge}}});
    model.light({.kind = scene::LightKind::Quad, .intensity = glm::vec3(5.0f), .size = {size, size}},
                glm::translate(glm::dmat4(1.0), {0.0, 0.0, Height}));
    // From below the edge. A light at x shadows all beyond -x.
    constexpr double Eye = 0.9, Span = 0.8;
    view::View view = small_view({0.0, 0.0, Eye}, 2.0 * std::atan(0.5 * Span / Eye), Pixels);
    view.max_bounces = 0;
    const std::vector<glm::dvec3> pixels = effect_picture(model.build(), view, 16);
    std::vector<double> profile(Pixels);
    for (std::size_t i = 0; i < pixels.size(); ++i) profile[i % Pixels] += pixels[i].x / Pixels;
    const double lit = profile.front(), dark = profile.back();
    EXPECT_EQ(dark, 0.0);
    const auto crossing = [&](double fraction) {
        for (std::uint32_t x = 1; x < Pixels; ++x) {
            if (profile[x] > fraction * lit) continue;
            return x - (fraction * lit - profile[x]) / (profile[x - 1] - profile[x]);
        }
        return double(Pixels);
    };
    return (crossing(0.1) - crossing(0.9)) * Span / Pixels;
}

TEST(Effects, ShadowsAreSofterUnderLargerLights) {
    // Halfway up the penumbra is as wide as the light, and 80 % of a linear slope are between the two levels.
    for (const float size : {0.1f, 0.2f, 0.4f}) {
        EXPECT_NEAR(penumbra_width(size) / (0.8 * double(size)), 1.0, 0.1) << size;
    }
}

TEST(Effects, MirrorsReflectTheSkyAndNotTheBackdrop) {
    // The sky has a column of 3 around (1, 0, 1), and one of 4 around (-1, 0, 1); the camera itself sees a backdrop.
    for (const bool to_right : {true, false}) {
        Model model;
        std::vector<glm::vec3> texels;
        for (const float value : {1.0f, 2.0f, 3.0f, 4.0f}) texels.emplace_back(value, 0.5f * value, 7.0f);
        const scene::Texture map{.width = 4, .height = 1, .format = scene::TexelFormat::RgbFloat};
        model.sky(scene::Background{.environment = model.texture(map, texels).texture,
                                    .visible = scene::VisibleBackground::Color,
                                    .visible_color = {0.25f, 0.5f, 0.75f, 1.0f}});
        model.set_frame(glm::rotate(glm::translate(glm::dmat4(1.0), {0.0, 0.0, -3.0}),
                                    (to_right ? 1.0 : -1.0) * M_PI / 8.0, {0.0, 1.0, 0.0}));
        model.floor(model.material(mirror(glm::vec3(1.0f))), 1.0f, 0.0f);
        const SceneAdapter& world = model.build();
        const glm::dvec3 mirrored = mean_light(world, small_view({}, 1e-3, 4), 4);
        const double value = to_right ? 3.0 : 4.0;
        EXPECT_NEAR(mirrored.x, value, 1e-3 * value);
        EXPECT_NEAR(mirrored.y, 0.5 * value, 1e-3 * value);
        EXPECT_NEAR(mirrored.z, 7.0, 1e-3);
        const view::View elsewhere =
            small_view({}, 1e-3, 4, glm::rotate(glm::dmat4(1.0), 1.0, {0.0, 1.0, 0.0}));
        EXPECT_EQ(glm::vec3(mean_light(world, elsewhere, 4)), glm::vec3(0.25f, 0.5f, 0.75f));
    }
}

TEST(Effects, EdgesAreAntialiasedByTheAreaOfThePixel) {
    // A bright panel covers the left half of the picture, and this part of the next column.
    constexpr std::uint32_t Size = 8;
    for (const double part : {0.1, 0.5, 0.8}) {
        Model model;
        const auto edge = static_cast<float>(2.0 / Size * part);
        model.quad(model.material(lamp(1.0f)), {{{-2, -2, -1}, {edge, -2, -1}, {edge, 2, -1}, {-2, 2, -1}}});
        view::View view = small_view({}, 0.5 * M_PI, Size);
        view.max_bounces = 0;
        const std::vector<glm::dvec3> pixels = effect_picture(model.build(), view, 64);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const std::size_t x = i % Size;
            const double expected = x < Size / 2 ? 1.0 : x > Size / 2 ? 0.0 : part;
            EXPECT_NEAR(pixels[i].x, expected, x == Size / 2 ? 0.02 : 0.0) << part << " at " << i;
        }
    }
}

TEST(Effects, TransmittedLightHasTheColourOfThePane) {
    const glm::vec3 tint(0.9f, 0.3f, 0.1f);
    const auto light_below = [&](bool paned) {
        Model model;
        model.floor(model.material(chalk(glm::vec3(0.8f))), 10.0f, 0.0f);
        scene::Material pane = glass(1.5f, tint);
        pane.thickness = 0.0f;
        if (paned) model.floor(model.material(pane), 5.0f, 1.0f);
        model.light(sun(3.0f), glm::dmat4(1.0));
        return mean_light(model.build(), floor_at(0.0, 0), 16);
    };
    const glm::dvec3 open = light_below(false), through = light_below(true);
    ASSERT_GT(open.x, 0.1);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(through[c] / open[c], 0.96 * double(tint[c]), 0.002) << c;
}

}  // namespace
}  // namespace tessera::embree
