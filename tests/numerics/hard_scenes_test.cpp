// Whole scenes at the limits of float precision: far from the origin and from each other, of any scale and unit of
// light, details next to huge walls, coplanar and needle-like triangles, grazing views, extreme fields of view.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/numerics/white_materials.h"
#include "tests/statistics/furnace.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

// The master keeps the render origin within one cell of the camera (master/scene/scene_authority.h).
constexpr double OriginCell = 256.0;

glm::dvec3 origin_near(const glm::dvec3& place) {
    return glm::round(place / OriginCell) * OriginCell;
}

// Every kind of lobe and of light within 3 m, seen from `place`.
struct StillLife {
    double scale = 1.0;
    float light = 1.0f;  // unit of its light
    glm::dvec3 place{0.0};
    bool has_speculars = true;

    void add_to(Model& model) const {
        model.set_frame(glm::scale(glm::translate(glm::dmat4(1.0), place), glm::dvec3(scale)));
        model.floor(model.material(chalk(glm::vec3(0.6f))), 3.0f, -1.0f);
        const scene::Material rough = chalk(glm::vec3(0.8f));
        model.sphere(model.material(has_speculars ? glass(1.5f) : rough), {-1.0, 0.2, -0.5}, 0.5);
        model.sphere(model.material(has_speculars ? mirror(glm::vec3(0.9f)) : rough), {0.2, 0.8, -0.5}, 0.5);
        model.sphere(model.material({.base_color = glm::vec4(0.8f), .metallic = 1.0f, .roughness = 0.3f}),
                     {1.0, -0.3, -0.6}, 0.4, Normals::Smooth);
        // Intensities of finite lights are per area, and their sizes in metres (mediator/scene/objects.h).
        const auto metre = static_cast<float>(scale);
        const float power = light * metre * metre;
        model.point_light({0.5, -1.0, 1.0}, 0.3f * power);
        model.light(
            {.kind = scene::LightKind::Quad, .intensity = glm::vec3(power), .size = {metre, 0.5f * metre}},
            glm::translate(glm::dmat4(1.0), {-0.5, 0.0, 1.5}));
        model.light({.kind = scene::LightKind::Sphere, .intensity = glm::vec3(power), .radius = 0.1f * metre},
                    glm::translate(glm::dmat4(1.0), {1.5, 1.0, 0.5}));
        model.sky(glm::vec3(0.3f * light));
    }
    view::View view() const {
        const glm::dvec3 eye(0.0, -3.0, 0.5);
        const glm::dmat4 turn =
            glm::inverse(glm::lookAt(glm::dvec3(0.0), glm::dvec3(0.0, 3.0, -1.0), glm::dvec3(0.0, 0.0, 1.0)));
        view::View view = small_view(place + scale * eye, 0.9, 16, turn);
        view.max_bounces = 6;
        return view;
    }
};

std::vector<glm::vec3> samples_of(const SceneAdapter& world, const view::View& view, std::uint64_t spp) {
    std::vector<glm::vec3> samples;
    for_samples(world, view, spp, [&](const PathSample& sample) { samples.push_back(radiance_of(sample)); });
    return samples;
}

// The share of samples that differ, and of those that differ by more than 1 %, and the error of the picture.
struct Difference {
    double samples = 0.0, paths = 0.0, relmse = 0.0;
};

Difference difference_of(const std::vector<glm::vec3>& found, const std::vector<glm::vec3>& expected,
                         std::size_t pixels) {
    Difference difference;
    const std::size_t spp = expected.size() / pixels;
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
        glm::dvec3 a(0.0), b(0.0);
        for (std::size_t sample = 0; sample < spp; ++sample) {
            const std::size_t i = sample * pixels + pixel;
            difference.samples += found[i] == expected[i] ? 0.0 : 1.0;
            difference.paths += std::fabs(found[i].x - expected[i].x) > 1e-2f * expected[i].x ? 1.0 : 0.0;
            a += glm::dvec3(found[i]);
            b += glm::dvec3(expected[i]);
        }
        const double mean = b.x + b.y + b.z, off = a.x + a.y + a.z - mean;
        difference.relmse += off * off / (mean * mean);
    }
    difference.samples /= double(expected.size());
    difference.paths /= double(expected.size());
    difference.relmse /= double(pixels);
    return difference;
}

std::vector<glm::vec3> samples_of(const StillLife& scene, std::uint64_t spp) {
    Model model(origin_near(scene.place));
    scene.add_to(model);
    return samples_of(model.build(), scene.view(), spp);
}

constexpr std::size_t Pixels = 16 * 16;

double rays_per_sample(const StillLife& scene) {
    Model model(origin_near(scene.place));
    scene.add_to(model);
    SceneAdapter& world = model.build();
    const view::View view = scene.view();
    const PathTracer tracer(world.tables(), world.scene(), view);
    std::uint64_t rays = 0;
    for (std::uint32_t pixel = 0; pixel < Pixels; ++pixel) tracer.trace(pixel % 16, pixel / 16, 0, rays);
    return double(rays) / double(Pixels);
}

// Where the render origin is exactly as far away as the scene, nothing is rounded.
TEST(HardScenes, HaveTheSameBitsFarFromTheOrigin) {
    const std::vector<glm::vec3> expected = samples_of({}, 64);
    const std::vector<glm::vec3> found = samples_of({.place = {0x1p23, -0x1p23, 0x1p22}}, 64);
    EXPECT_EQ(difference_of(found, expected, Pixels).samples, 0.0);
}

// 1e7 m are no multiple of a cell, so that all coordinates are rounded at half a cell, to 2^-18 m: a path meets another
// triangle only if one of its rays comes as near to an edge as that. Then its light is another one, and a picture has an error
// of their share over the samples per pixel, unless a path through facets of glass finds a lamp instead of a wall.
TEST(HardScenes, HaveTheSamePictureAtTenThousandKilometres) {
    // Of a facet of the larger spheres, of which a side is the 24th part of half a circle: its circumference by its area.
    const double side = 0.5 * M_PI / 24.0;
    const double near_edges = 0x1p-18 * (2.0 + std::sqrt(2.0)) * side / (0.5 * side * side);
    for (const bool has_speculars : {false, true}) {
        const std::vector<glm::vec3> expected = samples_of({.has_speculars = has_speculars}, 256);
        const Difference far = difference_of(
            samples_of({.place = {1e7, -1e7, 1e7}, .has_speculars = has_speculars}, 256), expected, Pixels);
        EXPECT_GT(far.samples, 0.0) << "nothing was rounded";
        EXPECT_LT(far.paths, has_speculars ? near_edges * rays_per_sample({}) : 1e-3);
        EXPECT_LT(far.relmse, has_speculars ? 1e-5 : 1e-6);
    }
}

// No epsilon in metres, and none in units of light, except for subnormal numbers.
TEST(HardScenes, HaveTheSameBitsAtScalesOfPowersOfTwo) {
    const std::vector<glm::vec3> expected = samples_of({}, 16);
    for (const double scale : {0x1p-20, 0x1p-7, 0x1p7, 0x1p20})
        EXPECT_EQ(difference_of(samples_of({.scale = scale}, 16), expected, Pixels).samples, 0.0) << scale;
}

TEST(HardScenes, HaveTheSameBitsInUnitsOfPowersOfTwo) {
    const std::vector<glm::vec3> expected = samples_of({}, 16);
    for (const float light : {0x1p-60f, 0x1p-20f, 0x1p20f, 0x1p60f}) {
        std::vector<glm::vec3> found = samples_of({.light = light}, 16);
        for (glm::vec3& sample : found) sample /= light;
        EXPECT_EQ(difference_of(found, expected, Pixels).samples, 0.0) << light;
    }
}

TEST(HardScenes, AreFiniteInSubnormalLight) {
    std::size_t lit = 0;
    for (const glm::vec3& sample : samples_of({.light = 1e-42f}, 16)) {
        ASSERT_TRUE(std::isfinite(sample.x) && sample.x >= 0.0f);
        ASSERT_LT(sample.x, 1e-38f);
        lit += sample.x > 0.0f ? 1 : 0;
    }
    EXPECT_GT(lit, 0u) << "subnormal numbers were flushed";
}

// One scene with two objects, 1e7 m apart: each looks as if it were alone.
TEST(HardScenes, ObjectsFarApartDoNotBlurEachOther) {
    const glm::dvec3 far = origin_near({1e7, -1e7, 1e7});
    const auto samples_at = [&](const glm::dvec3& camera, bool has_both) {
        Model model(camera);
        for (const glm::dvec3& place : {glm::dvec3(0.0), far}) {
            if (place != camera && !has_both) continue;
            model.placed_at(place);
            const ObjectId chalked = model.material(chalk(glm::vec3(0.6f)));
            model.floor(chalked, 3.0f, -1.0f);
            model.sphere(chalked, {0.2, 0.8, -0.5}, 0.5);
        }
        model.sky(glm::vec3(0.3f));
        const StillLife scene{.place = camera};
        return samples_of(model.build(), scene.view(), 16);
    };
    const std::vector<glm::vec3> expected = samples_at(glm::dvec3(0.0), false);
    for (const glm::dvec3& camera : {glm::dvec3(0.0), far})
        EXPECT_EQ(difference_of(samples_at(camera, true), expected, Pixels).samples, 0.0) << camera.x;
}

// A post of 1 mm on a floor of 2 km under a lamp at 3 cm: the shadow that a double-precision ray finds.
TEST(HardScenes, AMillimetreNextToAKilometre) {
    constexpr double Size = 1e-3, Eye = 6e-3, Fov = 1.2;
    const glm::dvec3 lamp_place(0.02, 0.01, 0.03);
    Model model;
    const ObjectId chalked = model.material(chalk(glm::vec3(1.0f)));
    model.floor(chalked, 1000.0f, 0.0f);
    model.quad(chalked, {{{1e-2f, -1000, -1000}, {1e-2f, 1000, -1000}, {1e-2f, 1000, 0}, {1e-2f, -1000, 0}}});
    const auto half = static_cast<float>(0.5 * Size);
    model.box(chalked, {-half, -half, 0.0f}, {half, half, static_cast<float>(Size)});
    model.point_light(lamp_place, 1e-3f);
    view::View view = small_view({0.0, 0.0, Eye}, Fov, 32);
    view.max_bounces = 0;
    // What a ray downwards meets: the top of the post, its sides never, or the floor.
    const auto light_at = [&](double x, double y) {
        const double reach = std::tan(0.5 * Fov);
        const glm::dvec3 direction(reach * x, reach * y, -1.0);
        const glm::dvec3 eye(0.0, 0.0, Eye);
        glm::dvec3 place = eye + (Eye - Size) * direction;
        const bool is_top = std::fabs(place.x) <= 0.5 * Size && std::fabs(place.y) <= 0.5 * Size;
        if (!is_top) {
            place = eye + Eye * direction;
            // The post is a slab in each axis.
            double enters = 0.0, leaves = 1.0;
            const glm::dvec3 way = lamp_place - place, low(-0.5 * Size, -0.5 * Size, 0.0);
            for (int axis = 0; axis < 3; ++axis) {
                const double a = (low[axis] - place[axis]) / way[axis];
                const double b = (low[axis] + Size - place[axis]) / way[axis];
                enters = std::max(enters, std::min(a, b));
                leaves = std::min(leaves, std::max(a, b));
            }
            if (enters < leaves) return 0.0;
        }
        const glm::dvec3 way = lamp_place - place;
        return 1e-3 / M_PI * way.z / std::pow(glm::dot(way, way), 1.5);
    };
    double expected = 0.0;
    constexpr int Steps = 2000;
    for (int y = 0; y < Steps; ++y) {
        for (int x = 0; x < Steps; ++x)
            expected += light_at(2.0 * (x + 0.5) / Steps - 1.0, 2.0 * (y + 0.5) / Steps - 1.0);
    }
    expected /= double(Steps) * Steps;
    const Mean mean = mean_of(model.build(), view, 64, red);
    // 65,536 stratified samples are a grid of 256 x 256. Edges of at most 4 widths cross 1,024 of its cells, whose samples
    // are on either side by chance: a standard error of sqrt(1024) / 2 / 65536, of which this is four.
    EXPECT_NEAR(mean.value, expected, 1e-3 * expected);
}

// Chalk under an even sky, without indirect light: every sample of what is seen is its albedo exactly, unless a ray
// meets its own surface again, or one beneath.
void expect_albedos(Model& model, const std::vector<float>& albedos) {
    model.sky(glm::vec3(1.0f));
    view::View view = small_view({0.1, -0.1, 2.0}, 0.7);
    view.max_bounces = 0;
    const SceneAdapter& world = model.build();
    std::size_t wrong = 0;
    for_samples(world, view, 64, [&](const PathSample& sample) {
        const double value = red(sample);
        ASSERT_TRUE(std::isfinite(value));
        bool is_one = false;
        for (const float albedo : albedos) is_one |= std::fabs(value - double(albedo)) < 1e-6;
        wrong += is_one ? 0 : 1;
    });
    EXPECT_EQ(wrong, 0u);
}

TEST(HardScenes, CoplanarSurfacesAreNotInTheirOwnShadow) {
    Model model;
    model.floor(model.material(chalk(glm::vec3(0.25f))), 1.0f, 0.0f);
    model.floor(model.material(chalk(glm::vec3(0.75f))), 1.0f, 0.0f);
    expect_albedos(model, {0.25f, 0.75f});
}

TEST(HardScenes, OfNearlyCoplanarSurfacesTheUpperIsSeen) {
    // Down to what a float of 1 m resolves, with room for the error box of a ray's hit.
    for (const float gap : {1e-3f, 1e-5f, 2e-6f}) {
        Model model;
        model.floor(model.material(chalk(glm::vec3(0.25f))), 1.0f, 0.0f);
        model.floor(model.material(chalk(glm::vec3(0.75f))), 1.0f, gap);
        expect_albedos(model, {0.75f});
    }
}

TEST(HardScenes, SlabsOfTenMicrometresLetNoLightThrough) {
    Model model;
    const ObjectId chalked = model.material(chalk(glm::vec3(0.5f)));
    constexpr float Thin = 1e-5f;
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            glm::vec3 low(-1.0f - Thin), high(1.0f + Thin);
            (side < 0.0f ? high : low)[axis] = side;
            model.box(chalked, low, high);
        }
    }
    model.sky(glm::vec3(1.0f));
    view::View view = small_view({0.1, 0.2, 0.3}, 1.5);
    view.max_bounces = 16;
    for_samples(model.build(), view, 64, [&](const PathSample& sample) { ASSERT_EQ(red(sample), 0.0); });
}

// A floor of needles up to 10^6 times as long as they are wide, with degenerate triangles among them.
TEST(HardScenes, NeedlesAndEmptyTrianglesAreAFloor) {
    std::vector<std::array<glm::vec3, 3>> triangles;
    float from = -1.0f;
    for (int i = 0; from < 1.0f; ++i) {
        const float width = std::array{0.05f, 1e-3f, 2e-6f}[static_cast<std::size_t>(i % 3)];
        const float to = std::min(from + width, 1.0f);
        const glm::vec3 a(from, -1, 0), b(to, -1, 0), c(to, 1, 0), d(from, 1, 0);
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
        triangles.push_back({a, a, c});               // an edge
        triangles.push_back({b, b, b});               // a point
        triangles.push_back({a, 0.5f * (a + d), d});  // a line
        from = to;
    }
    Model model;
    model.triangles(model.material(chalk(glm::vec3(0.5f))), triangles);
    expect_albedos(model, {0.5f});
}

// Views along a white floor in a white sky: not brighter than the sky, and as bright if the lobe loses nothing.
TEST(HardScenes, GrazingViewsOfEveryLobeConserveEnergy) {
    for (const test::WhiteMaterial& kind : test::white_materials()) {
        for (const double height : {1e-1, 1e-3, 1e-5}) {
            SCOPED_TRACE(testing::Message() << kind.name << " " << height);
            Model model;
            model.floor(model.material(kind.material), 100.0f, 0.0f);
            model.sky(glm::vec3(1.0f));
            // Down by its height a metre away.
            view::View view =
                small_view({0.0, 0.0, height}, 1e-3 * height, 16,
                           glm::rotate(glm::dmat4(1.0), M_PI / 2 - std::atan(height), {1, 0, 0}));
            view.max_bounces = 64;
            double sum = 0.0, squares = 0.0, count = 0.0;
            for_samples(model.build(), view, 32, [&](const PathSample& sample) {
                const double value = red(sample);
                ASSERT_TRUE(std::isfinite(value) && value >= 0.0);
                ASSERT_NE(sample.object, 0u);
                sum += value;
                squares += value * value;
                ++count;
            });
            const double mean = sum / count;
            const double error = std::sqrt(std::max(0.0, squares / count - mean * mean) / count);
            // 33 of these: 4.5 standard errors; the energy tables resolve 3e-3.
            EXPECT_LE(mean, 1.0 + 4.5 * error + 3e-3);
            if (kind.is_clear) {
                EXPECT_GE(mean, 1.0 - 4.5 * error - 1e-5);
            }
        }
    }
}

// Fog in a box of any size: only its optical thickness matters, whatever the albedo.
TEST(HardScenes, MediaHaveTheSameBitsAtScalesOfPowersOfTwo) {
    for (const float albedo : {0.0f, 0.5f, 0.9999f, 1.0f}) {
        std::vector<glm::vec3> expected;
        for (const float scale : {1.0f, 0x1p-20f, 0x1p20f}) {
            Model model;
            model.scaled_by(double(scale));
            model.set_medium({.absorption = glm::vec3(4.0f * (1.0f - albedo) / scale),
                              .scattering = glm::vec3(4.0f * albedo / scale)});
            model.box({}, {-1, -1, -1}, {1, 1, 1});
            model.sky(glm::vec3(1.0f));
            const std::vector<glm::vec3> found =
                samples_of(model.build(), small_view({0.0, 0.0, 4.0 * double(scale)}, 0.7), 16);
            for (const glm::vec3& sample : found) ASSERT_TRUE(std::isfinite(sample.x) && sample.x >= 0.0f);
            if (expected.empty()) expected = found;
            EXPECT_EQ(difference_of(found, expected, Pixels).samples, 0.0) << albedo << " " << scale;
        }
    }
}

// A panel that fills the middle half of the picture in both directions fills a quarter of the samples.
TEST(HardScenes, PicturesOfAnyFieldOfView) {
    for (const double degrees : {0.05, 1.0, 60.0, 170.0, 179.0}) {
        const double fov = degrees / 180.0 * M_PI;
        const auto half = static_cast<float>(10.0 * std::tan(0.5 * fov) * 0.5);
        Model model;
        model.floor(model.material(lamp(1.0f)), half, -10.0f);
        const Mean mean = mean_of(model.build(), small_view(glm::dvec3(0.0), fov, 32), 16, red);
        // The panel's edges are pixel edges: rounding may move them by 2^-24 of a distance, 2^-20 of a picture.
        EXPECT_NEAR(mean.value, 0.25, 1e-5) << degrees;
    }
}

// Paths of ten thousand bounces, each of which emits: the sum of the geometric series.
TEST(HardScenes, AFurnaceOfAlbedoNearlyOne) {
    const Furnace furnace(0.9999f);
    view::View view = small_view(glm::dvec3(0.0), 1.0, 8);
    const Mean mean = mean_of(furnace.world, view, 16, red);
    const double expected = 1.0 / (1.0 - double(0.9999f));
    EXPECT_LE(mean.standard_error, 0.05 * expected);
    EXPECT_NEAR(mean.value, expected, 4.5 * mean.standard_error);
}

}  // namespace
}  // namespace tessera::embree
