// The path tracer against Cycles, which shares no code with it: Lambertian scenes whose means per block of pixels
// Blender rendered once (make_references.py).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "client/import/scene_transfer.h"
#include "tests/import/inspect.h"
#include "tests/statistics/model.h"
#include "tests/support/folders.h"

namespace tessera::embree {
namespace {

using nlohmann::json;

json reference(const std::string& name) {
    std::ifstream file(TESSERA_RECORDED "/" + name + ".json");
    return json::parse(file);
}

std::filesystem::path scene_file(const json& given) {
    const std::string name = given["scene"];
    const std::filesystem::path made = std::filesystem::path(TESSERA_RECORDED) / name;
    return std::filesystem::exists(made) ? made : test::scenes_folder() / name;
}

// A Lambertian of the base colour and the emission.
scene::Material lambertian(const scene::Material& material) {
    return {.name = material.name,
            .base_color = material.base_color,
            .base_color_texture = material.base_color_texture,
            .metallic = 0.0f,
            .roughness = 1.0f,
            .emission = material.emission,
            .emission_texture = material.emission_texture,
            .double_sided = true,
            .specular = 0.0f};
}

// As make_references.py prepares it in Blender.
void prepare(import::ImportedScene& scene, const json& given) {
    const std::set<std::string> left_out(given["left_out"].begin(), given["left_out"].end());
    for (scene::Create& create : scene.objects) {
        if (auto* material = std::get_if<scene::Material>(&create.object)) *material = lambertian(*material);
        if (auto* texture = std::get_if<scene::Texture>(&create.object);
            texture && texture->format != scene::TexelFormat::RgbFloat)
            texture->filter = scene::TextureFilter::Nearest;
        if (auto* geometry = std::get_if<scene::Geometry>(&create.object))
            geometry->normals = geometry->tangents = {};
        if (auto* transform = std::get_if<scene::Transform>(&create.object)) {
            if (left_out.contains(transform->name)) transform->children.clear();
        }
    }
}

view::View view_of(const import::ImportedScene& scene, const json& given) {
    view::View view;
    view.width = given["width"];
    view.height = given["height"];
    view.window = {0, 0, static_cast<std::int32_t>(view.width), static_cast<std::int32_t>(view.height)};
    view.max_bounces = given["bounces"];
    view.seed = 7;
    for (const import::CameraInfo& camera : scene.cameras) {
        if (camera.name != given["camera"]) continue;
        view.camera = view::perspective(camera.world_from_camera, double(camera.camera.vertical_fov),
                                        double(view.width) / double(view.height));
    }
    return view;
}

// Blocks are compared to this fraction, half of what means must keep: under a large lamp seen at an angle Cycles is up to
// 1 % off Lambert's closed form, which TriangleLights.HaveLambertsIrradiance keeps to 0.1 %.
constexpr double Precision = 5e-3;

struct Block {
    glm::dvec3 sum{0.0}, squares{0.0};  // of the pixels' means
};

// Each block's mean, and its standard error from the spread of independent rounds.
constexpr int Rounds = 8;
constexpr std::uint64_t PerRound = 32;

class AgainstCycles : public testing::TestWithParam<const char*> {};

TEST_P(AgainstCycles, BlocksHaveTheSameMeans) {
    const json given = reference(GetParam());
    import::ImportOptions options;
    const auto background = given["background"];
    options.background = glm::vec3(background[0], background[1], background[2]);
    const std::string environment = given["environment"];
    if (!environment.empty()) options.environment = test::scenes_folder() / environment;
    options.light_units = import::LightUnits::Blender;
    import::ImportedScene scene = import::loaded(scene_file(given), options);
    prepare(scene, given);
    const view::View base = view_of(scene, given);
    const auto blobs = std::make_shared<scene::BlobStore>();
    for (const scene::BlobPtr& blob : scene.blobs) blobs->insert(blob);
    DeviceHandle device = make_device({.threads = 1, .blobs = blobs});
    SceneAdapter world{device.get(), blobs};
    scene::Scene whole;
    ASSERT_TRUE(whole.apply_entries(import::entries(scene, import::RootEntry::Create)));
    ASSERT_TRUE(world.apply(scene::snapshot(whole)));
    ASSERT_TRUE(world.commit());
    const std::size_t size = given["block"], columns = base.width / size, rows = base.height / size;
    std::vector<Block> blocks(columns * rows);
    for (int round = 0; round < Rounds; ++round) {
        view::View view = base;
        view.seed = 100 + static_cast<std::uint64_t>(round);
        const PathTracer tracer(world.tables(), world.scene(), view);
        std::vector<glm::dvec3> means(blocks.size(), glm::dvec3(0.0));
        std::uint64_t rays = 0;
        for (std::uint32_t y = 0; y < view.height; ++y) {
            for (std::uint32_t x = 0; x < view.width; ++x) {
                for (std::uint64_t i = 0; i < PerRound; ++i)
                    means[y / size * columns + x / size] +=
                        glm::dvec3(radiance_of(tracer.trace(x, y, i, rays)));
            }
        }
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            const glm::dvec3 mean = means[b] / double(size * size * PerRound);
            blocks[b].sum += mean;
            blocks[b].squares += mean * mean;
        }
    }
    double ours = 0.0, theirs = 0.0, worst = 0.0;
    int beyond = 0, compared = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        for (int c = 0; c < 3; ++c) {
            const double mean = blocks[b].sum[c] / Rounds;
            const double variance = (blocks[b].squares[c] / Rounds - mean * mean) / (Rounds - 1);
            const double expected = given["means"][b][c], error = given["errors"][b][c];
            const double spread = std::sqrt(std::max(variance, 0.0) + error * error);
            const double off = std::max(0.0, std::fabs(mean - expected) - Precision * expected);
            const double deviation = off / std::max(spread, 1e-9);
            ours += mean;
            theirs += expected;
            worst = std::max(worst, deviation);
            beyond += deviation > 3.0 ? 1 : 0;
            ++compared;
        }
    }
    std::printf(
        "%-20s mean %.5f, of Cycles %.5f, ratio %.4f; %d of %d beyond 3 standard errors, worst %.1f\n",
        GetParam(), ours / compared, theirs / compared, ours / theirs, beyond, compared, worst);
    EXPECT_NEAR(ours / theirs, 1.0, 0.01);
    // With errors from 8 rounds (Student's t), 1.5 % are.
    EXPECT_LE(beyond, compared / 25);
}

INSTANTIATE_TEST_SUITE_P(Scenes, AgainstCycles,
                         testing::Values("room", "interior", "many-lamps", "textured-floor",
                                         "mirrored-instances", "sky", "blender-lights"),
                         [](const auto& given) {
                             std::string name = given.param;
                             std::erase(name, '-');
                             return name;
                         });

}  // namespace
}  // namespace tessera::embree
