#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "mediator/backend/flattening.h"
#include "mediator/scene/validate.h"
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

namespace tessera::import {
namespace {

using scene::Transform;
using testing::ElementsAre;

ImportedScene load(const SceneFile& file, const ImportOptions& options = {}) {
    const TestFolder folder;
    ImportedScene scene = loaded(folder.write("scene.glb", file.glb()), options);
    expect_consistent(scene, options);
    return scene;
}

// A mesh of one triangle, with index 0.
void add_mesh(SceneFile& file, const std::string& more = "") {
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    file.add("meshes",
             R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + "}" + more + "}]}");
}

backend::FlatScene flattened(const ImportedScene& imported) {
    scene::Scene scene;
    const auto applied = scene.apply_entries(entries(imported, RootEntry::Create));
    if (!applied) ADD_FAILURE() << applied.error().what();
    for (const scene::Problem& problem : scene::validate(scene)) ADD_FAILURE() << problem.message;
    const auto result = backend::flatten(scene);
    if (!result) ADD_FAILURE() << result.error().what();
    return result.value_or(backend::FlatScene{});
}

TEST(GltfScene, NestedTransformsMultiplyFromTheRootDown) {
    // Translate by (10, 0, 0), then rotate by 90 degrees about y (x goes to -z), then scale by 2, 3, 4: the
    // point (1, 1, 1) of the mesh becomes (2, 3, 4), then (4, 3, -2), then (14, 3, -2).
    SceneFile file;
    add_mesh(file);
    const double half = std::numbers::sqrt2 / 2;
    file.add("nodes", R"({"translation":[10,0,0],"children":[1]})");
    file.add("nodes", R"({"rotation":[0,)" + std::to_string(half) + ",0," + std::to_string(half) +
                          R"(],"children":[2]})");
    file.add("nodes", R"({"matrix":[2,0,0,0, 0,3,0,0, 0,0,4,0, 0,0,0,1],"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const backend::FlatScene flat = flattened(load(file));
    ASSERT_EQ(flat.instances.size(), 1u);
    const glm::dvec4 point = flat.instances[0].world_from_object * glm::dvec4(1, 1, 1, 1);
    EXPECT_NEAR(point.x, 14.0, 1e-5);
    EXPECT_NEAR(point.y, 3.0, 1e-12);
    EXPECT_NEAR(point.z, -2.0, 1e-5);
}

TEST(GltfScene, TranslationRotationAndScaleOfOneNodeApplyInGltfOrder) {
    SceneFile file;
    add_mesh(file);
    // Half a turn about z by a quaternion that is not normalized.
    file.add("nodes", R"({"translation":[0,5,0],"rotation":[0,0,2,0],"scale":[2,1,1],"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const ImportedScene scene = load(file);
    const glm::dvec4 point = all<Transform>(scene)[0]->matrix * glm::dvec4(1, 1, 0, 1);
    EXPECT_NEAR(glm::distance(point, glm::dvec4(-2, 4, 0, 1)), 0.0, 1e-12);
}

TEST(GltfScene, NodesThatShareAMeshShareItsGeometry) {
    SceneFile file;
    add_mesh(file);
    for (int i = 0; i < 3; ++i)
        file.add("nodes", R"({"mesh":0,"translation":[)" + std::to_string(i) + ",0,0]}");
    file.add("scenes", R"({"nodes":[0,1,2]})");
    const ImportedScene scene = load(file);
    EXPECT_EQ(all<scene::Geometry>(scene).size(), 1u);
    EXPECT_EQ(scene.counts.geometries, 1u);
    EXPECT_EQ(scene.counts.instances, 3u);
    EXPECT_EQ(scene.counts.triangles, 1u);
    std::set<ObjectId> children;
    for (const Transform* node : all<Transform>(scene)) {
        if (node->name.starts_with("node")) children.insert(node->children.begin(), node->children.end());
    }
    EXPECT_EQ(children.size(), 1u);
}

TEST(GltfScene, EqualArraysAreOneBlob) {
    SceneFile file;
    add_mesh(file);
    add_mesh(file);
    file.add("nodes", R"({"mesh":0})");
    file.add("nodes", R"({"mesh":1})");
    file.add("scenes", R"({"nodes":[0,1]})");
    ImportOptions dark;  // without the texels of the default environment
    dark.background = glm::vec3(0.0f);
    const ImportedScene scene = load(file, dark);
    EXPECT_EQ(scene.counts.geometries, 2u);
    EXPECT_EQ(scene.blobs.size(), 2u) << "indices and positions";
}

TEST(GltfScene, GpuInstancesAreTransformsOverOneGeometry) {
    SceneFile file;
    add_mesh(file);
    const int translation = file.positions({{1, 0, 0}, {2, 0, 0}});
    const int scale = file.positions({{1, 1, 1}, {5, 5, 5}});
    const int rotation = file.accessor(file.view(std::vector<glm::i8vec4>{{0, 0, 0, 127}, {0, 0, 127, 0}}),
                                       Component::Byte, "VEC4", 2, R"(,"normalized":true)");
    file.set("extensionsRequired", R"(["EXT_mesh_gpu_instancing"])");
    file.add("nodes",
             R"({"mesh":0,"translation":[0,0,9],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":)"
             R"({"TRANSLATION":)" +
                 std::to_string(translation) + R"(,"SCALE":)" + std::to_string(scale) + R"(,"ROTATION":)" +
                 std::to_string(rotation) + "}}}}");
    file.add("scenes", R"({"nodes":[0]})");
    const ImportedScene scene = load(file);
    EXPECT_EQ(scene.counts.geometries, 1u);
    EXPECT_EQ(scene.counts.instances, 2u);
    const backend::FlatScene flat = flattened(scene);
    ASSERT_EQ(flat.instances.size(), 2u);
    const glm::dvec4 a = flat.instances[0].world_from_object * glm::dvec4(1, 0, 0, 1);
    const glm::dvec4 b = flat.instances[1].world_from_object * glm::dvec4(1, 0, 0, 1);
    EXPECT_NEAR(glm::distance(a, glm::dvec4(2, 0, 9, 1)), 0.0, 1e-6);
    EXPECT_NEAR(glm::distance(b, glm::dvec4(-3, 0, 9, 1)), 0.0, 1e-6);
}

TEST(GltfScene, LayersAreInTheExtrasOfNodes) {
    SceneFile file;
    add_mesh(file);
    const std::vector<std::string> extras{R"({"tessera_layers":6})",
                                          R"({"tessera_layers":4294967295})",
                                          R"({"tessera_layers":2.0})",
                                          R"({"tessera_layers":2.5})",
                                          R"({"tessera_layers":"two"})",
                                          R"({"tessera_layers":1e12})",
                                          R"({"other":2})",
                                          "3"};
    const std::vector<std::uint32_t> expected{6, 0xffffffff, 2, 0, 0, 0, 0, 0};
    std::string roots;
    for (std::size_t i = 0; i < extras.size(); ++i) {
        file.add("nodes", R"({"mesh":0,"name":"n)" + std::to_string(i) + R"(","extras":)" + extras[i] + "}");
        roots += (i == 0 ? "" : ",") + std::to_string(i);
    }
    file.add("scenes", R"({"nodes":[)" + roots + "]}");
    const ImportedScene scene = load(file);
    for (std::size_t i = 0; i < extras.size(); ++i) {
        EXPECT_EQ(named<Transform>(scene, "n" + std::to_string(i)).layers, expected[i]) << extras[i];
    }
    const auto count = std::count_if(scene.notices.begin(), scene.notices.end(), [](const std::string& text) {
        return text.find("tessera_layers") != std::string::npos;
    });
    EXPECT_EQ(count, 3);
}

TEST(GltfScene, GpuInstancesOfUnequalLengthsDrawOneAndReportIt) {
    SceneFile file;
    add_mesh(file);
    const int translation = file.positions({{1, 0, 0}, {2, 0, 0}});
    const int scale = file.positions({{1, 1, 1}});
    file.add("nodes", R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" +
                          std::to_string(translation) + R"(,"SCALE":)" + std::to_string(scale) + "}}}}");
    file.add("scenes", R"({"nodes":[0]})");
    const ImportedScene scene = load(file);
    EXPECT_EQ(scene.counts.instances, 1u);
    EXPECT_TRUE(has_notice(scene, "differ in length"));
}

TEST(GltfScene, OnlyTheDefaultSceneIsDrawn) {
    SceneFile file;
    add_mesh(file);
    file.add("nodes", R"({"mesh":0,"name":"first"})");
    file.add("nodes", R"({"mesh":0,"name":"second"})");
    file.add("scenes", R"({"nodes":[0]})");
    file.add("scenes", R"({"nodes":[1]})");
    file.set("scene", "1");
    const ImportedScene scene = load(file);
    named<Transform>(scene, "second");
    EXPECT_EQ(scene.counts.instances, 1u);
    EXPECT_TRUE(has_notice(scene, "only scene 1"));
}

TEST(GltfScene, WithoutScenesAllRootNodesAreDrawn) {
    SceneFile file;
    add_mesh(file);
    file.add("nodes", R"({"mesh":0,"children":[1]})");
    file.add("nodes", R"({"mesh":0})");
    file.add("nodes", R"({"mesh":0})");
    EXPECT_EQ(load(file).counts.instances, 3u);
}

TEST(GltfScene, EqualAndMissingNamesBecomeUniqueAndStable) {
    SceneFile file;
    add_mesh(file);
    for (const char* name : {R"("name":"box")", R"("name":"box")", R"("name":"box.2")", R"("name":"")"}) {
        file.add("nodes", std::string(R"({"mesh":0,)") + name + "}");
    }
    file.add("scenes", R"({"nodes":[0,1,2,3]})");
    const auto names = [&] {
        std::vector<std::string> result;
        const ImportedScene scene = load(file);
        for (const Transform* node : all<Transform>(scene)) result.push_back(node->name);
        result.pop_back();  // of the framing camera
        return result;
    };
    EXPECT_THAT(names(), ElementsAre("box", "box.2", "box.2.2", "node 3"));
    EXPECT_EQ(names(), names());
}

TEST(GltfScene, CamerasAreListedWithTheirRigidPose) {
    SceneFile file;
    add_mesh(file);
    file.add("cameras", R"({"type":"perspective","perspective":{"yfov":0.5,"aspectRatio":1.5,"znear":0.1}})");
    file.add("cameras",
             R"({"type":"orthographic","orthographic":{"xmag":3,"ymag":2,"zfar":10,"znear":0.1}})");
    file.add("nodes", R"({"name":"parent","scale":[3,3,3],"translation":[0,1,0],"children":[1,2,3]})");
    file.add("nodes", R"({"name":"near","camera":0,"translation":[0,0,2]})");
    file.add("nodes", R"({"name":"flat","camera":1})");
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const ImportedScene scene = load(file);
    ASSERT_EQ(scene.cameras.size(), 2u);
    const CameraInfo& camera = scene.cameras[0];
    EXPECT_EQ(camera.name, "near");
    EXPECT_EQ(camera.camera.vertical_fov, 0.5);
    EXPECT_EQ(camera.camera.aspect_ratio, 1.5);
    EXPECT_EQ(camera.world_from_camera[3], glm::dvec4(0, 1, 6, 1));
    EXPECT_NEAR(glm::determinant(camera.world_from_camera), 1.0, 1e-12);
    EXPECT_EQ(scene.cameras[1].camera.projection, scene::Projection::Orthographic);
    EXPECT_EQ(scene.cameras[1].camera.orthographic_height, 4.0) << "ymag is half of it";
    EXPECT_EQ(scene.cameras[1].camera.aspect_ratio, 1.5);
    EXPECT_EQ(named<scene::Camera>(scene, "near").vertical_fov, 0.5);
}

TEST(GltfScene, ASceneWithoutACameraGetsAFramingCamera) {
    SceneFile file;
    const int at = file.positions({{-3, -2, -1}, {5, 4, 7}, {5, -2, 7}});
    file.add("meshes", R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + "}}]}");
    file.add("nodes", R"({"mesh":0,"translation":[100,0,0],"scale":[2,2,2]})");
    file.add("scenes", R"({"nodes":[0]})");
    const ImportedScene scene = load(file);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_TRUE(has_notice(scene, "no camera"));
    const double edge = std::tan(scene.cameras[0].camera.vertical_fov / 2);
    const glm::dmat4 camera_from_world = glm::inverse(scene.cameras[0].world_from_camera);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec4 world(corner & 1 ? 110 : 94, corner & 2 ? 8 : -4, corner & 4 ? 14 : -2, 1);
        const glm::dvec4 seen = camera_from_world * world;
        ASSERT_LT(seen.z, 0.0);
        EXPECT_LT(std::abs(seen.y / seen.z), edge);
        EXPECT_LT(std::abs(seen.x / seen.z), edge);
    }
}

TEST(GltfScene, PunctualLightsAreReadAndCountAsLight) {
    SceneFile file;
    add_mesh(file);
    file.set("extensionsUsed", R"(["KHR_lights_punctual"])");
    file.set("extensions", R"({"KHR_lights_punctual":{"lights":[
        {"type":"point","intensity":10,"color":[1,0.5,0]},
        {"type":"directional","name":"sun","intensity":3,"range":5},
        {"type":"spot","intensity":2,"spot":{"innerConeAngle":0.1,"outerConeAngle":0.2}},
        {"type":"spot","name":"broken","intensity":2,"spot":{"innerConeAngle":0.5,"outerConeAngle":0.2}},
        {"type":"point","name":"negative","intensity":-1}]}})");
    file.add("nodes", R"({"mesh":0})");
    for (int light = 0; light < 6; ++light) {
        file.add("nodes", R"({"name":"place )" + std::to_string(light) +
                              R"(","extensions":{"KHR_lights_punctual":{"light":)" + std::to_string(light) +
                              "}}}");
    }
    file.add("scenes", R"({"nodes":[0,1,2,3,4,5,6]})");
    ImportOptions blender;
    blender.light_units = LightUnits::Blender;
    const ImportedScene watts = load(file, blender);
    EXPECT_FLOAT_EQ(named<scene::Light>(watts, "sun").intensity.x, 3.0f / 683.0f);
    EXPECT_FLOAT_EQ(named<scene::Light>(watts, "place 0").intensity.y, 5.0f / 683.0f);
    EXPECT_TRUE(has_notice(watts, "683 lm/W"));
    const ImportedScene scene = load(file);
    EXPECT_FALSE(has_notice(scene, "683"));
    EXPECT_TRUE(has_notice(scene, "light 'sun': its range is not used"));
    EXPECT_EQ(scene.counts.lights, 3u);
    const scene::Light& point = named<scene::Light>(scene, "place 0");
    EXPECT_EQ(point.kind, scene::LightKind::Point);
    EXPECT_EQ(point.intensity, glm::vec3(10, 5, 0)) << "candela are taken as W/sr";
    EXPECT_EQ(named<scene::Light>(scene, "sun").intensity, glm::vec3(3));
    EXPECT_FLOAT_EQ(named<scene::Light>(scene, "place 2").outer_cone_angle, 0.2f);
    EXPECT_TRUE(has_notice(scene, "cone angles"));
    EXPECT_TRUE(has_notice(scene, "intensity is negative"));
    EXPECT_TRUE(has_notice(scene, "its light 5 is missing"));
    EXPECT_FALSE(has_notice(scene, "default environment"));
    EXPECT_EQ(all<scene::Background>(scene)[0]->color, glm::vec3(0));
}

TEST(GltfScene, ASceneWithoutLightGetsADefaultEnvironmentUnlessTheBackgroundIsGiven) {
    SceneFile file;
    file.add_triangle();
    const ImportedScene dark = load(file);
    EXPECT_TRUE(has_notice(dark, "no light: a default environment (overcast sky) was added"));
    EXPECT_TRUE(all<scene::Background>(dark)[0]->environment);

    ImportOptions options;
    options.background = glm::vec3(0.1f, 0.2f, 0.3f);
    const ImportedScene given = load(file, options);
    EXPECT_FALSE(has_notice(given, "default environment"));
    EXPECT_FALSE(all<scene::Background>(given)[0]->environment);
    EXPECT_EQ(all<scene::Background>(given)[0]->color, glm::vec3(0.1f, 0.2f, 0.3f));

    options.background = glm::vec3(0.0f);
    EXPECT_EQ(all<scene::Background>(load(file, options))[0]->color, glm::vec3(0.0f)) << "black on purpose";
}

TEST(GltfScene, EmissiveMeshesCountAsLight) {
    SceneFile file;
    file.add("materials", R"({"emissiveFactor":[1,1,1]})");
    add_mesh(file, R"(,"material":0)");
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const ImportedScene scene = load(file);
    EXPECT_EQ(scene.counts.emissive_geometries, 1u);
    EXPECT_FALSE(has_notice(scene, "default environment"));
}

TEST(GltfScene, IdsStartWhereTheOptionsSayAndEndThereToo) {
    SceneFile file;
    file.add_triangle();
    ImportOptions options;
    options.first_id = ObjectId{1000};
    const ImportedScene scene = load(file, options);
    EXPECT_EQ(scene.objects.front().id, ObjectId{1000});
    options.end_id = ObjectId{1002};
    const TestFolder folder;
    const auto refused = import_scene(folder.write("scene.glb", file.glb()), options);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code(), ErrorCode::InvalidInput);
}

TEST(GltfScene, EntriesCreateOrUpdateTheRoot) {
    SceneFile file;
    file.add_triangle();
    const ImportedScene imported = load(file);
    EXPECT_EQ(flattened(imported).instances.size(), 1u);

    scene::Scene scene;
    scene::Root root;
    root.name = "mine";
    ASSERT_TRUE(scene.apply_entries({scene::Create{scene::RootId, root}}));
    ASSERT_TRUE(scene.apply_entries(entries(imported, RootEntry::Update)));
    const auto* updated = scene.find_as<scene::Root>(scene::RootId);
    ASSERT_TRUE(updated);
    EXPECT_EQ(updated->name, "mine");
    EXPECT_EQ(updated->children, imported.root.children);
    EXPECT_EQ(updated->background, imported.root.background);
}

TEST(GltfScene, TheSameFileGivesTheSameValues) {
    SceneFile file;
    file.add_triangle();
    const ImportedScene a = load(file), b = load(file);
    ASSERT_EQ(a.objects.size(), b.objects.size());
    for (std::size_t i = 0; i < a.objects.size(); ++i) {
        EXPECT_EQ(scene::object_hash(a.objects[i].id, a.objects[i].object),
                  scene::object_hash(b.objects[i].id, b.objects[i].object));
    }
}

}  // namespace
}  // namespace tessera::import
