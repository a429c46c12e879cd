// Extreme and malformed input to lobes: transforms of any shape, texels that are no light and no number, coats
// without roughness.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/numerics/white_materials.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

// Scales of x, y and z; `sheared`: shear of x by y.
struct Shape {
    const char* name;
    glm::dvec3 scale;
    double sheared = 0.0;
};

constexpr Shape Shapes[] = {{"plain", {1, 1, 1}},
                            {"mirrored", {-1, 1, 1}},
                            {"turned out", {-1, -1, -1}},
                            {"uneven", {0.1, 1, 3}},
                            {"sheared", {1, 1, 1}, 5.0},
                            {"flat", {1, 1, 1e-6}},
                            {"nearly flat", {1, 1, 1e-12}},
                            {"thin", {1e-5, 1, 1}},
                            {"mirrored and sheared", {1, -0.5, 2}, -3.0}};

glm::dmat4 matrix_of(const Shape& shape) {
    glm::dmat4 matrix = glm::scale(glm::dmat4(1.0), shape.scale);
    glm::dmat4 shear(1.0);
    shear[1][0] = shape.sheared;
    return glm::rotate(glm::dmat4(1.0), 0.3, {0.2, 1.0, 0.1}) * shear * matrix;
}

// A deformed white sphere in a white sky: its mean is not brighter than the sky, up to the resolution of the energy
// tables (3e-3), and equal for lossless materials. Non-finite samples fail.
TEST(ExtremeTransforms, EveryLobeConservesEnergy) {
    for (const test::WhiteMaterial& kind : test::white_materials()) {
        double plain = 0.0;
        for (const Shape& shape : Shapes) {
            SCOPED_TRACE(testing::Message() << kind.name << " " << shape.name);
            Model model;
            model.set_frame(matrix_of(shape));
            model.sphere(model.material(kind.material), {}, 1.0, Normals::Smooth);
            model.sky(glm::vec3(1.0f));
            const SceneAdapter& world = model.build();
            view::View view = small_view({0.0, 0.0, 8.0}, 0.25);
            view.max_bounces = 200;
            double sum = 0.0, squares = 0.0, hits = 0.0;
            for_samples(world, view, 32, [&](const PathSample& sample) {
                const double value = red(sample);
                ASSERT_TRUE(std::isfinite(value) && value >= 0.0);
                if (sample.object == 0) return;
                sum += value;
                squares += value * value;
                ++hits;
            });
            if (std::fabs(shape.scale.x) > 1e-3) {
                ASSERT_GT(hits, 100.0);
            }
            if (hits == 0.0) continue;
            const double mean = sum / hits;
            const double error = std::sqrt(std::max(0.0, squares / hits - mean * mean) / hits);
            // 90 of these: 4.5 standard errors.
            EXPECT_LE(mean, 1.0 + 4.5 * error + 3e-3);
            // Where shading and geometric normals disagree about the side, some light is blocked.
            if (kind.is_clear) {
                EXPECT_GE(mean, 1.0 - 4.5 * error - 0.05);
            }
            if (shape.name == std::string("plain")) plain = mean;
            if (shape.name == std::string("mirrored")) {
                EXPECT_NEAR(mean, plain, 6.0 * error + 1e-3);
            }
        }
    }
}

// A plane stays the same under stretching along itself, flattening across, and mirroring: the picture does not
// change beyond noise.
TEST(ExtremeTransforms, APlaneStaysAPlane) {
    for (const test::WhiteMaterial& kind : test::white_materials()) {
        if (kind.name == std::string("clear glass") || kind.name == std::string("rough glass")) continue;
        double plain = 0.0, plain_error = 0.0;
        for (const glm::dvec3 scale : {glm::dvec3(1.0), glm::dvec3(-1, 1, 1), glm::dvec3(1e3, 1e3, 1e-9),
                                       glm::dvec3(1e3, 30.0, -1e-12)}) {
            Model model;
            model.set_frame(glm::scale(glm::dmat4(1.0), scale));
            model.floor(model.material(kind.material), 30.0f, 0.0f);
            model.set_frame(glm::dmat4(1.0));
            model.light({.kind = scene::LightKind::Quad, .intensity = glm::vec3(3.0f), .size = {2.0f, 2.0f}},
                        glm::translate(glm::dmat4(1.0), {0.5, 0.3, 2.0}));
            model.sky(glm::vec3(0.5f));
            view::View view = small_view({0.0, 0.0, 1.5}, 0.4);
            view.max_bounces = 1;
            const Mean mean = mean_of(model.build(), view, 128, red);
            if (plain == 0.0) {
                plain = mean.value;
                plain_error = mean.standard_error;
            }
            EXPECT_NEAR(mean.value, plain, 4.5 * std::hypot(mean.standard_error, plain_error) + 1e-4 * plain)
                << kind.name << " " << scale.x << " " << scale.z;
        }
    }
}

// White under a smooth coat: reflection and transmission of the coat sum to at most 1. Attenuating by the smaller
// transmittance of both directions loses less than a tenth.
TEST(SmoothCoat, ConservesEnergy) {
    for (const float metallic : {0.0f, 1.0f}) {
        for (const float weight : {0.0f, 0.3f, 1.0f}) {
            for (const double angle : {0.0, 0.8, 1.3, 1.5}) {
                scene::Material material{
                    .base_color = glm::vec4(1.0f), .metallic = metallic, .roughness = 0.5f};
                material.clearcoat = weight;
                Model model;
                model.floor(model.material(material), 1e3f, 0.0f);
                model.sky(glm::vec3(1.0f));
                const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), angle, {1.0, 0.0, 0.0});
                view::View view = small_view(turn * glm::dvec4(0, 0, 5, 1), 0.01, 16, turn);
                const Mean mean = mean_of(model.build(), view, 64, red);
                EXPECT_LE(mean.value, 1.0 + 4.5 * mean.standard_error + 3e-3) << weight << " " << angle;
                EXPECT_GE(mean.value, 1.0 - 0.1 * weight - 4.5 * mean.standard_error - 5e-3)
                    << metallic << " " << weight << " " << angle;
            }
        }
    }
}

// ---- texels ----

constexpr float NotANumber = std::numeric_limits<float>::quiet_NaN();
constexpr float Infinite = std::numeric_limits<float>::infinity();

// Rejected when merging samples: a value of its radiance is not finite.
bool is_rejected(const PathSample& sample) {
    const glm::vec3 radiance = radiance_of(sample);
    return !std::isfinite(radiance.x) || !std::isfinite(radiance.y) || !std::isfinite(radiance.z);
}

// Four adjacent texels, nearest filtering, on a quad in front of the camera.
scene::TextureSlot four(Model& model, const std::array<float, 4>& values) {
    std::vector<glm::vec3> texels;
    for (const float value : values) texels.emplace_back(value);
    scene::Texture texture{.width = 4, .height = 1, .format = scene::TexelFormat::RgbFloat};
    texture.filter = scene::TextureFilter::Nearest;
    return model.texture(texture, texels);
}

struct Quarters {
    std::array<double, 4> mean{};
    std::array<int, 4> rejected{}, count{};
};

Quarters seen_quarters(Model& model, const scene::Material& material) {
    model.textured_quad(model.material(material), {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, 1.0f);
    model.sky(glm::vec3(1.0f));
    const SceneAdapter& world = model.build();
    view::View view = small_view({0.0, 0.0, 2.0}, 1.0);
    const PathTracer tracer(world.tables(), world.scene(), view);
    Quarters found;
    std::uint64_t rays = 0;
    for (std::uint64_t sample = 0; sample < 64; ++sample) {
        for (std::uint32_t x = 0; x < 16; ++x) {
            // Each quarter of the quad is left alone at its edges.
            const double place = 0.5 + (x + 0.5 - 8.0) / 8.0 * std::tan(0.5);
            const auto quarter = std::size_t(std::clamp(place, 0.0, 0.999) * 4.0);
            const double inside = place * 4.0 - double(quarter);
            if (inside < 0.2 || inside > 0.8) continue;
            const PathSample path = tracer.trace(x, 8, sample, rays);
            ++found.count[quarter];
            if (is_rejected(path)) {
                ++found.rejected[quarter];
            } else {
                found.mean[quarter] += red(path);
            }
        }
    }
    for (std::size_t i = 0; i < 4; ++i) found.mean[i] /= std::max(1, found.count[i] - found.rejected[i]);
    return found;
}

// Invalid colours do not affect their neighbours: negative and NaN texels reflect nothing, too large ones are
// clamped to white, and the valid texel is unchanged.
TEST(InvalidTexels, InBaseColourAffectOnlyTheirPixels) {
    Model model;
    scene::Material material = chalk(glm::vec3(1.0f));
    material.base_color_texture = four(model, {0.5f, -1.0f, NotANumber, Infinite});
    const Quarters found = seen_quarters(model, material);
    for (std::size_t i = 0; i < 4; ++i) ASSERT_GT(found.count[i], 60) << i;
    EXPECT_NEAR(found.mean[0], 0.5, 0.01);
    EXPECT_EQ(found.rejected[0], 0);
    EXPECT_EQ(found.mean[1], 0.0);
    EXPECT_EQ(found.rejected[1], 0);
    EXPECT_EQ(found.mean[2], 0.0);
    EXPECT_EQ(found.rejected[2], 0);
    EXPECT_NEAR(found.mean[3], 1.0, 0.02) << "no surface reflects more than all";
}

TEST(InvalidTexels, InEmissionAffectOnlyTheirPixels) {
    Model model;
    scene::Material material = lamp(1.0f);
    material.emission_texture = four(model, {0.5f, -1.0f, NotANumber, Infinite});
    const Quarters found = seen_quarters(model, material);
    EXPECT_NEAR(found.mean[0], 0.5, 1e-5);
    EXPECT_EQ(found.rejected[0] + found.rejected[1], 0);
    EXPECT_EQ(found.mean[1], 0.0) << "what shines less than nothing does not shine";
    EXPECT_EQ(found.mean[2], 0.0) << "NaN texels emit nothing";
    EXPECT_EQ(found.rejected[3], found.count[3]);
}

// A sky with an invalid texel: surfaces that do not see it are lit by the rest, without bias.
TEST(InvalidTexels, InASkyDoNotAffectOtherLight) {
    for (const float bad : {-3.0f, NotANumber, Infinite}) {
        Model model;
        model.floor(model.material(chalk(glm::vec3(0.5f))), 1.0f, 0.0f);
        // The lower half of the map: the ground does not see it. The map's +y is up.
        std::vector<glm::vec3> texels(64 * 32, glm::vec3(1.0f));
        texels[28 * 64 + 10] = glm::vec3(bad);
        const scene::TextureSlot map = model.texture(
            scene::Texture{.width = 64, .height = 32, .format = scene::TexelFormat::RgbFloat}, texels);
        model.sky(scene::Background{.environment = map.texture});
        view::View view = small_view({0.0, 0.0, 1.0}, 0.1);
        view.max_bounces = 0;
        double sum = 0.0, squares = 0.0, count = 0.0, rejected = 0.0;
        for_samples(model.build(), view, 256, [&](const PathSample& sample) {
            ++count;
            if (is_rejected(sample)) {
                ++rejected;
                return;
            }
            sum += red(sample);
            squares += red(sample) * red(sample);
        });
        // The floor faces +z, the map's horizon: half of what it sees is the map's lower half.
        const double good = count - rejected, mean = sum / good;
        const double error = std::sqrt(std::max(0.0, squares / good - mean * mean) / good);
        EXPECT_LT(error, 0.01) << bad;
        EXPECT_LT(rejected, 0.02 * count) << bad;
        EXPECT_NEAR(mean, 0.5, 4.5 * error + 0.01) << bad;
    }
}

}  // namespace
}  // namespace tessera::embree
