#include <glm/geometric.hpp>
#include <set>

#include "mediator/backend/flattening.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/validate.h"
#include "tests/import/animated_file.h"
#include "tests/import/inspect.h"

// glTF animations, skins and morph targets against poses computed by hand.
namespace tessera::import {
namespace {

using scene::Geometry;
using scene::Transform;
using testing::ElementsAre;

ImportedScene load_animated(const SceneFile& file, const ImportOptions& options = {}) {
    const TestFolder folder;
    ImportedScene scene = loaded(folder.write("scene.glb", file.glb()), options);
    expect_consistent(scene, options);
    return scene;
}

ImportedScene at(double seconds, Motion motion = Motion::Still) {
    return load_animated(moving_file(), {.at = seconds, .motion = motion});
}

// World positions of the vertices of a geometry, over all instances.
std::vector<glm::dvec3> seen(const ImportedScene& imported, const std::string& name) {
    scene::Scene scene;
    if (const auto applied = scene.apply_entries(entries(imported, RootEntry::Create)); !applied)
        ADD_FAILURE() << applied.error().what();
    for (const scene::Problem& problem : scene::validate(scene)) ADD_FAILURE() << problem.message;
    const auto flat_scene = backend::flatten(scene);
    std::vector<glm::dvec3> points;
    for (const backend::Instance& instance : flat_scene->instances) {
        const auto& geometry = *scene.find_as<Geometry>(instance.geometry);
        if (geometry.name != name) continue;
        for (const glm::vec3& position : values<glm::vec3>(imported, geometry.positions))
            points.emplace_back(instance.world_from_object * glm::dvec4(glm::dvec3(position), 1.0));
    }
    return points;
}

void expect_places(const std::vector<glm::dvec3>& points, const std::vector<glm::dvec3>& expected) {
    ASSERT_EQ(points.size(), expected.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_NEAR(glm::distance(points[i], expected[i]), 0.0, 2e-6) << i;
}

TEST(GltfAnimation, WithoutATimeTheRestPoseIsUsedAndAnimationsAreListed) {
    const ImportedScene scene = load_animated(moving_file());
    expect_places(seen(scene, "arm"), {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 2, 0}});
    EXPECT_EQ(named<Transform>(scene, "cart").matrix, glm::dmat4(1.0));
    ASSERT_EQ(scene.animations.size(), 4u);
    EXPECT_EQ(scene.animations[2].name, "smile");
    EXPECT_EQ(scene.animations[1].seconds, 1.0);
    EXPECT_TRUE(has_notice(scene, "0 'drive' (2 s), 1 'wave' (1 s)"));
    EXPECT_TRUE(has_notice(scene, "the rest pose is drawn"));
    EXPECT_EQ(scene.playback, nullptr);
}

// The hand is at (5, 1) and turned by 45 degrees about it at 1 s / 2; at 1 s by 90: (x, y) goes to (-y, x).
TEST(GltfAnimation, ASkinFollowsItsJointsAndIgnoresItsNode) {
    expect_places(seen(at(1.0), "arm"), {{5, 0, 0}, {6, 0, 0}, {4, 1, 0}, {4, 2, 0}});
    const double r = 0.5 * std::sqrt(2.0);
    expect_places(seen(at(0.5), "arm"), {{2.5, 0, 0}, {3.5, 0, 0}, {2.5 - r, 1 + r, 0}, {2.5, 1 + 2 * r, 0}});
    const auto normals = values<glm::vec3>(at(1.0), named<Geometry>(at(1.0), "arm").normals);
    EXPECT_NEAR(glm::distance(normals[3], {0, 0, 1}), 0.0, 1e-6);
}

TEST(GltfAnimation, MorphWeightsMoveOneNodeOnly) {
    const ImportedScene scene = at(0.5);
    expect_places(seen(scene, "face"), {{0, 0, 0}, {1, 0, 0}, {0, 1, 1.5}});
    expect_places(seen(scene, "face.2"), {{0, 0, 0}, {0.25, 0, 0}, {0, 0.25, 0}});
}

TEST(GltfAnimation, CamerasFollowTheirNodes) {
    const ImportedScene scene = at(1.0);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(glm::dvec3(scene.cameras[0].world_from_camera[3]), glm::dvec3(5, 0, 5));
}

TEST(GltfAnimation, OneIsChosenByNameOrNumber) {
    for (const std::string choice : {"drive", "0"}) {
        const ImportedScene scene = load_animated(moving_file(), {.at = 1.0, .animation = choice});
        expect_places(seen(scene, "arm"), {{5, 0, 0}, {6, 0, 0}, {5, 2, 0}, {6, 2, 0}});
    }
    const TestFolder folder;
    const auto missing =
        import_scene(folder.write("scene.glb", moving_file().glb()), {.at = 1.0, .animation = "run"});
    ASSERT_FALSE(missing);
    EXPECT_THAT(missing.error().what(),
                testing::HasSubstr("no animation 'run'; it has: 0 'drive', 1 'wave'"));
}

TEST(GltfAnimation, OfTwoThatAnimateTheSamePropertyTheFirstIsPlayed) {
    SceneFile file = moving_file();
    const int times = file.accessor(file.view(std::vector<float>{0, 1}), Component::Float, "SCALAR", 2);
    file.add("animations", animation("up", times, file.positions({{0, 9, 0}, {0, 9, 0}}), 0, "translation"));
    const ImportedScene scene = load_animated(file, {.at = 1.0});
    EXPECT_EQ(named<Transform>(scene, "cart").matrix[3], glm::dvec4(5, 0, 0, 1));
    EXPECT_TRUE(
        has_notice(scene, "animation 'up' animates properties that an earlier animation also animates"));
    EXPECT_EQ(named<Transform>(load_animated(file, {.at = 1.0, .animation = "up"}), "cart").matrix[3],
              glm::dvec4(0, 9, 0, 1));
}

TEST(GltfAnimation, RestWeightsAreThoseOfTheNodeElseTheMesh) {
    SceneFile file;
    const int place = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const std::string primitive = R"({"attributes":{"POSITION":)" + std::to_string(place) +
                                  R"(},"targets":[{"POSITION":)" + std::to_string(place) + "}]}";
    file.add("meshes", R"({"name":"m","weights":[2],"primitives":[)" + primitive + "]}");
    file.add("nodes", R"({"mesh":0})");
    file.add("nodes", R"({"mesh":0})");
    file.add("nodes", R"({"mesh":0,"weights":[0]})");
    file.add("scenes", R"({"nodes":[0,1,2]})");
    const ImportedScene scene = load_animated(file);
    EXPECT_EQ(scene.counts.geometries, 2u) << "nodes with the same deformation share it";
    expect_places(seen(scene, "m.2"), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    EXPECT_EQ(seen(scene, "m")[1], glm::dvec3(3, 0, 0));
}

TEST(GltfAnimation, SkinnedMeshesKeepTheLayersOfTheirNode) {
    const SceneFile file = moving_file();
    std::string json = file.json();
    const std::string body = R"("name":"body",)";
    json.insert(json.find(body), R"("extras":{"tessera_layers":4},)");
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", glb_of(json, file.buffer())));
    EXPECT_EQ(named<Transform>(scene, "body").layers, 4u);
    EXPECT_EQ(named<Transform>(scene, "body").matrix, glm::dmat4(1.0)) << "its own is ignored";
}

// Sample models: a skinned bar whose upper end rotates, and a morphed cube.
TEST(GltfAnimation, SampleModels) {
    const std::filesystem::path models = "/usr/share/assimp/models/glTF2";
    const std::filesystem::path bar = models / "simple_skin/simple_skin.gltf";
    const ImportedScene rest = loaded(bar), deformed = loaded(bar, {.at = 1.0});
    const auto before = seen(rest, "mesh 0"), after = seen(deformed, "mesh 0");
    ASSERT_EQ(before.size(), 10u);
    // Bound half a metre to the left and one below the joint at (0, 1, 0): so its rest pose is half a metre
    // left of its bind pose, and at 1 s its top has turned by 90 degrees about (0, 1, 0).
    EXPECT_NEAR(glm::distance(before[9], {0.5, 2, 0}), 0.0, 1e-6);
    EXPECT_NEAR(glm::distance(after[9], {-1, 1.5, 0}), 0.0, 1e-3) << "the file says 0.707";
    EXPECT_NEAR(glm::distance(after[0], before[0]), 0.0, 1e-6);
    const std::filesystem::path cube =
        models / "glTF-Sample-Models/AnimatedMorphCube-glTF/AnimatedMorphCube.gltf";
    EXPECT_EQ(loaded(cube).animations.at(0).name, "Square");
    EXPECT_NE(seen(loaded(cube), "Cube"), seen(loaded(cube, {.at = 1.0}), "Cube"));
}

void expect_same(const ImportedScene& a, const ImportedScene& b) {
    ASSERT_EQ(a.objects.size(), b.objects.size());
    for (std::size_t i = 0; i < a.objects.size(); ++i) {
        EXPECT_EQ(scene::differing_fields(a.objects[i].object, b.objects[i].object), 0u)
            << scene::name(a.objects[i].object);
    }
    std::set<Hash256> hashes_a, hashes_b;
    for (const scene::BlobPtr& blob : a.blobs) hashes_a.insert(blob->hash());
    for (const scene::BlobPtr& blob : b.blobs) hashes_b.insert(blob->hash());
    EXPECT_EQ(hashes_a, hashes_b);
    ASSERT_EQ(a.cameras.size(), b.cameras.size());
    for (std::size_t i = 0; i < a.cameras.size(); ++i)
        EXPECT_EQ(a.cameras[i].world_from_camera, b.cameras[i].world_from_camera);
}

TEST(GltfAnimation, MovingToATimeEqualsAnImportAtThatTime) {
    ImportedScene scene = at(0.0, Motion::Sequence);
    scene::Scene mirror;
    ASSERT_TRUE(mirror.apply_entries(entries(scene, RootEntry::Create)));
    EXPECT_EQ(named<Geometry>(scene, "arm").hint, scene::MotionHint::Animated);
    EXPECT_EQ(named<Transform>(scene, "cart").hint, scene::MotionHint::Animated);
    EXPECT_EQ(named<Geometry>(scene, "face.2").hint, scene::MotionHint::Unflagged);
    for (const double seconds : {0.25, 1.0, 2.5, 2.75, 0.0, 1.5}) {
        SCOPED_TRACE(seconds);
        const auto step = move_to(scene, seconds);
        ASSERT_TRUE(step) << step.error().what();
        expect_consistent(scene);
        expect_same(scene, at(seconds, Motion::Sequence));
        ASSERT_TRUE(mirror.apply_entries(step->entries));
        scene::Scene direct;
        ASSERT_TRUE(direct.apply_entries(entries(scene, RootEntry::Create)));
        EXPECT_EQ(mirror.state_hash(), direct.state_hash()) << "the updates contain everything that changed";
        EXPECT_EQ(step->entries.empty(), seconds == 2.75) << "after 2 s all keys are over";
    }
}

// From 0.5 s on for 0.75 s: the cart goes from 2.5 m to 6.25 m, the hand turns by 45 degrees and then stops,
// the weight goes from 0.5 to 1 and back to 0.75.
TEST(GltfShutter, AnimatedObjectsGetMotionKeys) {
    const ImportOptions options{.at = 0.5, .shutter = 0.75};
    const ImportedScene scene = load_animated(moving_file(), options);
    EXPECT_EQ(scene.playback, nullptr);
    const Transform& cart = named<Transform>(scene, "cart");
    ASSERT_EQ(cart.motion.size(), 1u) << "a straight line needs one";
    EXPECT_NEAR(cart.motion[0][3].x, 6.25, 1e-6);
    EXPECT_NEAR(cart.matrix[3].x, 2.5, 1e-6);
    EXPECT_EQ(named<Transform>(scene, "hand").motion.size(), 15u)
        << "45 degrees in 6-degree chords, and a corner";
    EXPECT_TRUE(named<Transform>(scene, "shoulder").motion.empty());

    const Geometry& face = named<Geometry>(scene, "face");
    ASSERT_EQ(face.motion_positions.size(), 3u) << "its corner is at 2/3 of the time";
    const std::vector<double> heights{1.5 + 0.75, 3.0, 2.25};
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(values<glm::vec3>(scene, face.motion_positions[i])[2].z, heights[i], 1e-5) << i;
    EXPECT_EQ(named<Geometry>(scene, "arm").motion_positions.size(), 15u);
    ASSERT_EQ(scene.cameras[0].motion.size(), 1u);
    EXPECT_NEAR(scene.cameras[0].motion[0][3].x, 6.25, 1e-6);
    expect_valid(scene);
}

// Each motion key equals an import of the file at its time.
TEST(GltfShutter, MotionKeysAreThePosesAtTheirTimes) {
    const ImportedScene scene = load_animated(moving_file(), {.at = 0.25, .shutter = 1.5});
    const Geometry& arm = named<Geometry>(scene, "arm");
    ASSERT_EQ(arm.motion_positions.size(), 15u);
    for (std::size_t i = 0; i < 15; ++i) {
        const ImportedScene later = at(0.25 + 0.1 * double(i + 1));
        const auto ours = values<glm::vec3>(scene, arm.motion_positions[i]),
                   theirs = values<glm::vec3>(later, named<Geometry>(later, "arm").positions);
        for (std::size_t v = 0; v < ours.size(); ++v)
            EXPECT_LT(glm::distance(ours[v], theirs[v]), 1e-5f) << i;
    }
}

TEST(GltfShutter, OpensAgainAtEachFrame) {
    const ImportOptions options{.at = 0.0, .shutter = 0.5, .motion = Motion::Sequence};
    ImportedScene scene = load_animated(moving_file(), options);
    scene::Scene mirror;
    ASSERT_TRUE(mirror.apply_entries(entries(scene, RootEntry::Create)));
    for (const double seconds : {0.25, 1.0, 1.75, 2.5}) {
        SCOPED_TRACE(seconds);
        const auto step = move_to(scene, seconds);
        ASSERT_TRUE(step) << step.error().what();
        expect_consistent(scene);
        ImportOptions again = options;
        again.at = seconds;
        expect_same(scene, load_animated(moving_file(), again));
        ASSERT_TRUE(mirror.apply_entries(step->entries));
        scene::Scene direct;
        ASSERT_TRUE(direct.apply_entries(entries(scene, RootEntry::Create)));
        EXPECT_EQ(mirror.state_hash(), direct.state_hash()) << "the updates contain everything that changed";
    }
    EXPECT_TRUE(named<Transform>(scene, "cart").motion.empty()) << "all keys are over";
    EXPECT_TRUE(named<Geometry>(scene, "face").motion_positions.empty());
}

TEST(GltfShutter, NeedsATimeAndALength) {
    const TestFolder folder;
    const auto file = folder.write("scene.glb", moving_file().glb());
    EXPECT_FALSE(import_scene(file, {.shutter = 0.5}));
    EXPECT_FALSE(import_scene(file, {.at = 0.0, .shutter = -0.5}));
    EXPECT_FALSE(import_scene(file, {.at = 0.0, .shutter = std::nan("")}));
}

TEST(GltfAnimation, DegenerateInstancesAreHiddenAndShownAgain) {
    ImportedScene scene = at(0.0, Motion::Sequence);
    EXPECT_TRUE(seen(scene, "face.2").empty());
    EXPECT_TRUE(has_notice(scene, "transform is degenerate"));
    ASSERT_TRUE(move_to(scene, 1.0));
    EXPECT_EQ(seen(scene, "face.2").size(), 3u);
    ASSERT_TRUE(move_to(scene, 0.0));
    EXPECT_TRUE(seen(scene, "face.2").empty());
}

}  // namespace
}  // namespace tessera::import
