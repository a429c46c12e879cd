// Filtering of textures over the footprint of a path: only colours that light is linear in are filtered, and the bias of
// those is below the noise of point samples.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "mediator/base/random.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using Corners = std::array<glm::vec3, 4>;
const Corners Ground{{{-10, -10, 0}, {10, -10, 0}, {10, 10, 0}, {-10, 10, 0}}};
constexpr std::uint32_t Edge = 256;  // texels

// Random bytes from `low` on.
scene::TextureSlot noise(Model& model, std::uint8_t low, std::uint8_t alpha_low = 255) {
    CounterRandom random(7, low);
    std::vector<std::uint8_t> texels;
    for (std::uint32_t i = 0; i < Edge * Edge; ++i) {
        for (int channel = 0; channel < 3; ++channel)
            texels.push_back(static_cast<std::uint8_t>(low + random.below(256 - low)));
        texels.push_back(static_cast<std::uint8_t>(alpha_low + random.below(256 - alpha_low)));
    }
    return model.texture(scene::Texture{.width = Edge, .height = Edge}, texels);
}

// 16 x 16 texels per pixel of 16 x 16 pixels.
view::View above_the_ground() {
    view::View view = small_view({0.0, 0.0, 10.0}, 2.0 * std::atan(1.0));
    view.max_bounces = 0;
    return view;
}

struct Case {
    const char* name;
    std::function<scene::Material(Model&)> material;
};

scene::Material metal() {
    return {.base_color = {0.9f, 0.7f, 0.5f, 1.0f}, .metallic = 1.0f, .roughness = 0.3f};
}

const Case Nonlinear[] = {{"normals",
                           [](Model& model) {
                               scene::Material material = metal();
                               material.normal_texture = noise(model, 90);
                               return material;
                           }},
                          {"roughness and metallic",
                           [](Model& model) {
                               scene::Material material = metal();
                               material.metallic_roughness_texture = noise(model, 0);
                               return material;
                           }},
                          {"colour and metallic",
                           [](Model& model) {
                               scene::Material material = metal();
                               material.base_color_texture = noise(model, 0);
                               material.metallic_roughness_texture = noise(model, 0);
                               return material;
                           }},
                          {"colour and normals",
                           [](Model& model) {
                               scene::Material material;
                               material.base_color_texture = noise(model, 0);
                               material.normal_texture = noise(model, 90);
                               return material;
                           }},
                          {"colour and alpha",
                           [](Model& model) {
                               scene::Material material{.alpha_mode = scene::AlphaMode::Mask};
                               material.base_color_texture = noise(model, 0, 0);
                               return material;
                           }},
                          {"coat",
                           [](Model& model) {
                               scene::Material material{.clearcoat = 1.0f, .clearcoat_roughness = 0.5f};
                               material.clearcoat_roughness_texture = noise(model, 0);
                               return material;
                           }},
                          {"anisotropy",
                           [](Model& model) {
                               scene::Material material = metal();
                               material.anisotropy = 1.0f;
                               material.anisotropy_texture = noise(model, 0);
                               return material;
                           }},
                          {"sheen", [](Model& model) {
                               scene::Material material{.sheen_color = glm::vec3(1.0f),
                                                        .sheen_roughness = 0.7f};
                               material.sheen_color_texture = noise(model, 0);
                               return material;
                           }}};

class TextureFilter : public testing::TestWithParam<Case> {};

// A sample's expectation must not depend on its index. With footprints, the film of 64 samples of the metal with
// random normals was twice as bright as that of 4096.
TEST_P(TextureFilter, LooksUpPointsOfWhatIsNotLinear) {
    Model model;
    model.textured_quad(model.material(GetParam().material(model)), Ground, 1.0f);
    model.floor(model.material(chalk(glm::vec3(0.5f))), 20.0f, -1.0f);
    model.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(3.0f)},
                glm::rotate(glm::dmat4(1.0), 0.3, {1.0, 0.0, 0.0}));
    model.sky(glm::vec3(0.5f));
    const SceneAdapter& world = model.build();
    backend::SceneTables points = world.tables();
    for (shading::Texture& texture : points.textures) texture.level_count = 0;
    const view::View view = above_the_ground();
    const PathTracer tracer(world.tables(), world.scene(), view), exact(points, world.scene(), view);
    std::uint64_t rays = 0;
    double brightness = 0.0;
    for (std::uint32_t i = 0; i < 16 * 16 * 4; ++i) {
        const std::uint32_t x = i % 16, y = i / 16 % 16, sample = i / 256;
        const PathSample found = tracer.trace(x, y, sample, rays);
        ASSERT_EQ(radiance_of(found), radiance_of(exact.trace(x, y, sample, rays))) << x << " " << y;
        brightness += red(found);
    }
    EXPECT_GT(brightness, 1.0);
}

INSTANTIATE_TEST_SUITE_P(Materials, TextureFilter, testing::ValuesIn(Nonlinear), [](const auto& test) {
    std::string name = test.param.name;
    std::ranges::replace(name, ' ', '_');
    return name;
});

// A wall of such a colour, and the same tables without mip levels.
struct Painted : Model {
    explicit Painted(bool has_edges) {
        scene::Material paint = chalk(glm::vec3(1.0f));
        if (has_edges) {
            // Stripes that are not aligned with pixels.
            std::vector<std::uint8_t> texels;
            for (std::uint32_t i = 0; i < Edge * Edge; ++i) {
                const bool is_bright = (i % Edge + i / Edge / 3) / 37 % 2 == 0;
                texels.insert(texels.end(), 4, is_bright ? std::uint8_t{255} : std::uint8_t{20});
            }
            paint.base_color_texture = texture(scene::Texture{.width = Edge, .height = Edge}, texels);
        } else {
            paint.base_color_texture = noise(*this, 0);
        }
        textured_quad(material(paint), Ground, 1.0f);
        light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(static_cast<float>(M_PI))},
              glm::dmat4(1.0));
        world = &build();
        points = world->tables();
        for (shading::Texture& texture : points.textures) texture.level_count = 0;
    }
    std::vector<double> picture(const backend::SceneTables& tables, std::uint64_t first,
                                std::uint64_t count) const {
        const PathTracer tracer(tables, world->scene(), above_the_ground());
        std::vector<double> pixels(256);
        std::uint64_t rays = 0;
        for (std::uint32_t pixel = 0; pixel < 256; ++pixel) {
            for (std::uint64_t sample = first; sample < first + count; ++sample)
                pixels[pixel] += red(tracer.trace(pixel % 16, pixel / 16, sample, rays)) / double(count);
        }
        return pixels;
    }
    const SceneAdapter* world = nullptr;
    backend::SceneTables points;
};

struct Errors {
    double rms = 0, most = 0;
};
Errors errors(const std::vector<double>& found, const std::vector<double>& truth) {
    Errors all;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const double error = found[i] - truth[i];
        all.rms += error * error / static_cast<double>(found.size());
        all.most = std::max(all.most, std::fabs(error));
    }
    all.rms = std::sqrt(all.rms);
    return all;
}

// Where a pixel covers many texels the film has less noise; at edges its bias stays within its bound. The contrast is 1.
TEST(FilteredColours, HaveLessNoiseAndABoundedBias) {
    for (const bool has_edges : {false, true}) {
        const Painted wall(has_edges);
        const auto truth = wall.picture(wall.points, 65536, 8192);
        for (const std::uint64_t spp : {1, 4, 16, 64, 256}) {
            const Errors filtered = errors(wall.picture(wall.world->tables(), 0, spp), truth);
            const Errors exact = errors(wall.picture(wall.points, 0, spp), truth);
            const double bound = 1.0 / std::sqrt(static_cast<double>(spp));
            EXPECT_LE(filtered.most, bound + exact.most) << spp;
            EXPECT_LE(filtered.rms, exact.rms + (has_edges ? 0.1 * bound : 0.0)) << spp;
            std::printf("%s, %d samples: error %.4f, of points %.4f; at most %.4f, %.4f\n",
                        has_edges ? "edges" : "noise", int(spp), filtered.rms, exact.rms, filtered.most,
                        exact.most);
        }
    }
}

}  // namespace
}  // namespace tessera::embree
