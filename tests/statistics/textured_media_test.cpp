// Textured media: extinction along rays against sums in double precision, furnaces, and extreme texel
// values.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mediator/base/random.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using glm::vec3;
using scene::Medium;

constexpr ObjectId MediumAlone{};

// Values of a lattice, by slices from z = 0 on, rows from the top.
struct Lattice {
    std::uint32_t width, height, depth;
    std::vector<float> values;

    double at(std::int64_t x, std::int64_t y, std::int64_t z) const {
        const auto inside = [](std::int64_t i, std::uint32_t size) {
            return static_cast<std::size_t>(std::clamp<std::int64_t>(i, 0, size - 1));
        };
        return values[(inside(z, depth) * height + inside(y, height)) * width + inside(x, width)];
    }
    // At a point of the box, [0, 1] along each axis.
    double filtered(const glm::dvec3& p) const {
        const glm::dvec3 place(p.x * width - 0.5, (1.0 - p.y) * height - 0.5, p.z * depth - 0.5);
        const glm::dvec3 first = glm::floor(place), fraction = place - first;
        double sum = 0.0;
        for (int i = 0; i < 8; ++i) {
            const double weight = ((i & 1) != 0 ? fraction.x : 1 - fraction.x) *
                                  ((i & 2) != 0 ? fraction.y : 1 - fraction.y) *
                                  ((i & 4) != 0 ? fraction.z : 1 - fraction.z);
            sum += weight * at(std::int64_t(first.x) + (i & 1), std::int64_t(first.y) + ((i >> 1) & 1),
                               std::int64_t(first.z) + (i >> 2));
        }
        return sum;
    }
    double nearest(const glm::dvec3& p) const {
        return at(std::int64_t(std::floor(p.x * width)), std::int64_t(std::floor((1.0 - p.y) * height)),
                  std::int64_t(std::floor(p.z * depth)));
    }
};

Lattice random_lattice(std::uint64_t seed) {
    CounterRandom random(seed);
    Lattice lattice{5, 4, 7, {}};
    for (int i = 0; i < 5 * 4 * 7; ++i) lattice.values.push_back(static_cast<float>(random.uniform()));
    return lattice;
}

scene::TextureSlot add_texture(Model& model, const Lattice& lattice, scene::TextureFilter filter) {
    std::vector<float> texels;
    for (const float value : lattice.values) texels.insert(texels.end(), {value, 0.5f * value, 0.0f});
    return model.texture({.width = lattice.width,
                          .height = lattice.height,
                          .format = scene::TexelFormat::RgbFloat,
                          .wrap_s = scene::Wrap::Clamp,
                          .wrap_t = scene::Wrap::Clamp,
                          .filter = filter,
                          .depth = lattice.depth},
                         texels);
}

// A box of size 2 x 4 x 6 centered at the origin, turned.
const glm::dmat4 Turned = glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
constexpr vec3 Half{1, 2, 3};

double depth_along(const Lattice& lattice, bool filters, const glm::dvec3& from, const glm::dvec3& to) {
    constexpr int Steps = 20000;
    const glm::dmat3 back = glm::transpose(glm::dmat3(Turned));
    double sum = 0.0;
    for (int i = 0; i < Steps; ++i) {
        const glm::dvec3 world = glm::mix(from, to, (i + 0.5) / Steps);
        const glm::dvec3 p = 0.5 * (back * world / glm::dvec3(Half) + 1.0);
        if (glm::any(glm::lessThan(p, glm::dvec3(0))) || glm::any(glm::greaterThan(p, glm::dvec3(1))))
            continue;
        sum += filters ? lattice.filtered(p) : lattice.nearest(p);
    }
    return sum / Steps * glm::length(to - from);
}

TEST(TexturedMedia, AbsorptionMatchesTheSumAlongTheRay) {
    const Lattice lattice = random_lattice(3);
    for (const bool filters : {true, false}) {
        Model model;
        model.set_frame(Turned);
        model.set_medium(
            {.absorption = vec3(0.5f),
             .absorption_texture = add_texture(
                 model, lattice, filters ? scene::TextureFilter::Linear : scene::TextureFilter::Nearest)});
        model.box(MediumAlone, -Half, Half);
        model.sky(vec3(1.0f));
        const SceneAdapter& world = model.build();
        EXPECT_TRUE(model.problems.empty());
        for (const glm::dvec3 eye : {glm::dvec3(0, 0, 10), glm::dvec3(0.5, -0.8, 10),
                                     glm::dvec3(-1.1, 0.3, 10), glm::dvec3(0.2, 0.1, 0.3)}) {
            const Mean seen = mean_of(world, small_view(eye, 1e-6), 1, red);
            const double depth = 0.5 * depth_along(lattice, filters, eye, eye - glm::dvec3(0, 0, 20));
            EXPECT_GT(depth, 0.05);
            EXPECT_NEAR(-std::log(seen.value), depth, 1e-3 * depth) << filters << " " << eye.x;
        }
    }
}

TEST(TexturedMedia, EmissionMatchesTheSumAlongTheRay) {
    const Lattice lattice = random_lattice(4);
    Model model;
    model.set_medium({.emission = vec3(2.0f),
                      .emission_texture = add_texture(model, lattice, scene::TextureFilter::Linear),
                      .absorption = vec3(0.4f)});
    model.box(MediumAlone, -Half, Half);
    const Mean seen = mean_of(model.build(), small_view({0.2, 0.4, 10}, 1e-6), 64, red);
    constexpr int Steps = 20000;
    double expected = 0.0;
    for (int i = 0; i < Steps; ++i) {
        const double distance = 6.0 * (i + 0.5) / Steps;
        const glm::dvec3 p = 0.5 * (glm::dvec3(0.2, 0.4, 3.0 - distance) / glm::dvec3(Half) + 1.0);
        expected += 2.0 * lattice.filtered(p) * std::exp(-0.4 * distance) * 6.0 / Steps;
    }
    EXPECT_NEAR(seen.value, expected, 4.5 * seen.standard_error + 1e-4 * expected);
    EXPECT_LE(seen.standard_error, 0.003 * expected);
}

// Scattering without absorption, in a lattice from empty to dense: whatever is sampled, nothing is lost.
TEST(TexturedMedia, APurelyScatteringMediumIsInvisible) {
    Lattice lattice = random_lattice(5);
    for (std::size_t i = 0; i < lattice.values.size(); i += 3) lattice.values[i] = 0.0f;
    for (const bool filters : {true, false}) {
        Model model;
        model.set_medium(
            {.scattering = vec3(4.0f),
             .scattering_texture = add_texture(
                 model, lattice, filters ? scene::TextureFilter::Linear : scene::TextureFilter::Nearest),
             .anisotropy = 0.3f});
        model.box(MediumAlone, -Half, Half);
        model.sky(vec3(1.0f));
        const SceneAdapter& world = model.build();
        for (int c = 0; c < 3; ++c) {
            const Mean mean = mean_of(world, small_view({0, 0, 10}, 0.5), 64,
                                      [&](const PathSample& s) { return double(radiance_of(s)[c]); });
            EXPECT_NEAR(mean.value, 1.0, 4.5 * mean.standard_error + 1e-4) << filters << " " << c;
            EXPECT_LE(mean.standard_error, 0.02);
        }
    }
}

// One scattering: path tracing against Whitted, which samples distances differently.
TEST(TexturedMedia, SingleScatteringAgreesInBothRenderers) {
    const Lattice lattice = random_lattice(6);
    Model model;
    model.set_medium({.absorption = vec3(0.1f),
                      .scattering = vec3(1.0f),
                      .scattering_texture = add_texture(model, lattice, scene::TextureFilter::Linear)});
    model.box(MediumAlone, -Half, Half);
    model.light({.kind = scene::LightKind::Directional, .intensity = vec3(1.0f)},
                glm::rotate(glm::dmat4(1.0), 1.0, glm::dvec3(1, 0, 0)));
    const SceneAdapter& world = model.build();
    view::View view = small_view({0, 0, 10}, 0.3);
    view.max_bounces = 0;
    const Mean traced = mean_of(world, view, 512, red);
    view.renderer = view::Renderer::Whitted;
    const Mean followed = mean_of(world, view, 512, red);
    EXPECT_NEAR(traced.value, followed.value,
                4.5 * std::hypot(traced.standard_error, followed.standard_error));
    EXPECT_LE(traced.standard_error, 0.01 * traced.value);
}

// NaN and negative texels are no extinction; infinite ones let nothing through.
TEST(TexturedMedia, NonFiniteTexelsAreHandled) {
    constexpr float Nan = std::numeric_limits<float>::quiet_NaN(),
                    Inf = std::numeric_limits<float>::infinity();
    for (const float value : {Nan, -1.0f, -Inf, Inf}) {
        Model model;
        const Lattice lattice{1, 1, 3, {value, value, value}};
        model.set_medium({.absorption = vec3(1.0f),
                          .absorption_texture = add_texture(model, lattice, scene::TextureFilter::Linear),
                          .scattering = vec3(1.0f),
                          .scattering_texture = add_texture(model, lattice, scene::TextureFilter::Linear)});
        model.box(MediumAlone, vec3(-1), vec3(1));
        model.sky(vec3(1.0f));
        const SceneAdapter& world = model.build();
        for_samples(world, small_view({0, 0, 5}, 0.2, 4), 16, [&](const PathSample& sample) {
            const vec3 seen = radiance_of(sample);
            EXPECT_TRUE(std::isfinite(seen.x) && std::isfinite(seen.y) && std::isfinite(seen.z)) << value;
            if (!(value > 0.0f)) {
                EXPECT_EQ(seen, vec3(1.0f)) << value;
            }
        });
    }
}

}  // namespace
}  // namespace tessera::embree
