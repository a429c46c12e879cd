#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <glm/geometric.hpp>

#include "client/export/export.h"
#include "mediator/backend/flattening.h"
#include "mediator/scene/fields.h"
#include "tests/export/rich_scene.h"
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"
#include "tests/support/folders.h"

// A .glb is restored by the importer: arrays and transforms are bit-exact (JSON numbers round-trip),
// materials as well, except for emission and light (factor times strength: 1e-6 relative).
namespace tessera::exporting {
namespace {

using Imported = import::ImportedScene;

scene::Scene scene_of(const import::ImportedScene& imported) {
    scene::Scene scene;
    const auto applied = scene.apply_entries(entries(imported, import::RootEntry::Create));
    if (!applied) ADD_FAILURE() << applied.error().what();
    return scene;
}

// One instance of a geometry, independent of names and ids.
struct InstanceData {
    glm::dmat4 world_from_object;
    scene::Geometry geometry;
    scene::Material material;
    std::vector<scene::Texture> textures;
    std::vector<glm::vec3> normals;
};

std::vector<InstanceData> instances_of(const scene::Scene& scene, const scene::BlobStore& blobs) {
    std::vector<InstanceData> result;
    const auto flat_scene = backend::flatten(scene);
    EXPECT_TRUE(flat_scene);
    for (const backend::Instance& instance : flat_scene->instances) {
        InstanceData data{
            instance.world_from_object, *scene.find_as<scene::Geometry>(instance.geometry), {}, {}, {}};
        if (const auto* material = scene.find_as<scene::Material>(data.geometry.material))
            data.material = *material;
        scene::for_each_field<scene::Material>([&](unsigned, auto member) {
            auto& slot = data.material.*member;
            if constexpr (std::is_same_v<std::decay_t<decltype(slot)>, scene::TextureSlot>) {
                const auto* texture = scene.find_as<scene::Texture>(slot.texture);
                data.textures.push_back(texture ? *texture : scene::Texture{});
                slot.texture = {};
            }
        });
        data.geometry.material = {};
        if (const scene::BlobPtr blob = blobs.find(data.geometry.normals.hash)) {
            const auto normals = blob->as<glm::vec3>();
            data.normals.assign(normals.begin(), normals.end());
        }
        data.geometry.normals = {};
        data.geometry.motion_positions = data.geometry.motion_normals = {};
        result.push_back(std::move(data));
    }
    std::sort(result.begin(), result.end(), [](const InstanceData& a, const InstanceData& b) {
        const auto key = [](const InstanceData& data) {
            return std::tuple(data.geometry.positions.hash, data.geometry.name, data.world_from_object[3].x,
                              data.world_from_object[3].y, data.world_from_object[3].z,
                              data.world_from_object[0].x, data.world_from_object[1].y);
        };
        return key(a) < key(b);
    });
    return result;
}

void expect_same(const InstanceData& a, const InstanceData& b) {
    EXPECT_EQ(a.world_from_object, b.world_from_object);
    ASSERT_EQ(a.normals.size(), b.normals.size());
    for (std::size_t i = 0; i < a.normals.size(); ++i)
        ASSERT_LT(glm::distance(a.normals[i], b.normals[i]), 3e-7f);
    EXPECT_EQ(scene::differing_fields(a.geometry, b.geometry) & ~1u, 0u) << "all but the name";
    scene::Material rounded = b.material;
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(a.material.emission[i], b.material.emission[i], 1e-6f * a.material.emission[i]);
    }
    rounded.emission = a.material.emission;
    EXPECT_EQ(scene::differing_fields(a.material, rounded) & ~1u, 0u)
        << a.material.name << " " << scene::differing_fields(a.material, rounded);
    ASSERT_EQ(a.textures.size(), b.textures.size());
    for (std::size_t i = 0; i < a.textures.size(); ++i)
        EXPECT_EQ(scene::differing_fields(a.textures[i], b.textures[i]) & ~1u, 0u);
}

void expect_equal_scenes(const scene::Scene& a, const scene::BlobStore& blobs,
                         const import::ImportedScene& imported) {
    scene::BlobStore other_blobs;
    for (const scene::BlobPtr& blob : imported.blobs) other_blobs.insert(blob);
    const std::vector<InstanceData> one = instances_of(a, blobs),
                                    other = instances_of(scene_of(imported), other_blobs);
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        SCOPED_TRACE(one[i].geometry.name);
        expect_same(one[i], other[i]);
    }
}

Imported through_glb(const scene::Scene& scene, const scene::BlobStore& blobs, Notices& notices) {
    const import::TestFolder folder;
    const auto file = folder.path() / "scene.glb";
    const auto written = write_glb(scene, blobs, file);
    if (!written) ADD_FAILURE() << written.error().what();
    notices = written.value_or(Notices{});
    Imported imported = import::loaded(file);
    import::expect_consistent(imported);
    return imported;
}

class GlbOfFile : public testing::TestWithParam<const char*> {};

TEST_P(GlbOfFile, IsRestored) {
    const import::ImportedScene imported = import::loaded(test::scenes_folder() / GetParam());
    scene::BlobStore blobs;
    for (const scene::BlobPtr& blob : imported.blobs) blobs.insert(blob);
    Notices notices;
    const scene::Scene before = scene_of(imported);
    const import::ImportedScene again = through_glb(before, blobs, notices);
    expect_equal_scenes(before, blobs, again);
    EXPECT_EQ(again.counts.triangles, imported.counts.triangles);
    EXPECT_EQ(again.counts.textures, imported.counts.textures);
    ASSERT_EQ(again.cameras.size(), imported.cameras.size());
    for (std::size_t i = 0; i < again.cameras.size(); ++i) {
        EXPECT_EQ(again.cameras[i].name, imported.cameras[i].name);
        EXPECT_EQ(again.cameras[i].world_from_camera, imported.cameras[i].world_from_camera);
        EXPECT_EQ(again.cameras[i].camera.vertical_fov, imported.cameras[i].camera.vertical_fov);
    }
    EXPECT_EQ(again.blobs.size(), imported.blobs.size());
}

INSTANTIATE_TEST_SUITE_P(Scenes, GlbOfFile, testing::Values("room-1.glb", "studio-1.glb", "still.glb"),
                         [](const auto& given) {
                             std::string name = given.param;
                             std::replace_if(
                                 name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
                             return name;
                         });

// Volumes need a closed mesh.
void close_square(RichScene& rich) {
    const std::vector<std::uint32_t> both_sides{0, 1, 2, 2, 1, 3, 0, 2, 1, 2, 3, 1};
    for (const auto& [id, object] : rich.scene.objects()) {
        const auto* found = std::get_if<scene::Geometry>(object.get());
        if (found == nullptr || found->name != "square") continue;
        scene::Geometry geometry = *found;
        geometry.indices = scene::reference(*rich.blobs.insert(std::as_bytes(std::span(both_sides))));
        ASSERT_TRUE(rich.scene.apply_entries(
            {scene::Update{id, scene::Fields<scene::Geometry>(&scene::Geometry::indices).bits(), geometry}}));
        return;
    }
}

TEST(GlbExport, EverythingThatGltfSupportsIsRestored) {
    RichScene rich;
    make_rich(rich);
    close_square(rich);
    Notices notices;
    const import::ImportedScene imported = through_glb(rich.scene, rich.blobs, notices);
    // A geometry without normals and with the default material keeps its arrays unchanged.
    expect_equal_scenes(rich.scene, rich.blobs, imported);
    for (const char* name : {"wheel", "left"}) import::named<scene::Transform>(imported, name);
    EXPECT_EQ(import::named<scene::Transform>(imported, "wheel").layers, 0x80000006u);
    EXPECT_EQ(import::named<scene::Transform>(imported, "left").layers, 0u);
    import::named<scene::Material>(imported, "my \"red\"");
    import::named<scene::Texture>(imported, "wood");

    const auto near = [](const glm::vec3& a, const glm::vec3& b) {
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-6f * b[i]);
    };
    near(import::named<scene::Light>(imported, "bulb").intensity, {3.0f, 2.0f, 0.1f});
    const auto& spot = import::named<scene::Light>(imported, "spot");
    EXPECT_EQ(spot.kind, scene::LightKind::Spot);
    near(spot.intensity, {100.0f, 90.0f, 80.0f});
    EXPECT_EQ(spot.inner_cone_angle, 0.2f);
    EXPECT_EQ(spot.outer_cone_angle, 0.5f);
    const auto& sun = import::named<scene::Light>(imported, "sun");
    EXPECT_EQ(sun.kind, scene::LightKind::Directional);
    EXPECT_EQ(sun.intensity, glm::vec3(0.0f));
    ASSERT_EQ(imported.cameras.size(), 1u);
    EXPECT_EQ(imported.cameras[0].camera.vertical_fov, 0.123456789);
    EXPECT_EQ(imported.cameras[0].camera.aspect_ratio, 1.5);
}

// glTF requires 0 < znear < zfar; Blender shows nothing otherwise.
TEST(GlbExport, CamerasHaveValidClippingPlanes) {
    RichScene rich;
    make_rich(rich);
    const import::TestFolder folder;
    const std::filesystem::path file = folder.path() / "clipping.glb";
    ASSERT_TRUE(write_glb(rich.scene, rich.blobs, file));
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    // The JSON chunk is the first one. All our cameras' lenses are in it.
    const auto number = [&](const std::string& name) {
        const std::size_t at = bytes.find("\"" + name + "\":");
        return at == std::string::npos ? 0.0 : std::strtod(bytes.c_str() + at + name.size() + 3, nullptr);
    };
    EXPECT_GT(number("znear"), 0.0);
    EXPECT_GT(number("zfar"), number("znear"));
}

TEST(GlbExport, UnsupportedPropertiesAreReported) {
    RichScene rich;
    make_rich(rich);
    Notices notices;
    through_glb(rich.scene, rich.blobs, notices);
    EXPECT_THAT(notices, testing::Contains(testing::HasSubstr("background")));
    EXPECT_THAT(notices, testing::Contains(testing::HasSubstr("attachments are left out: 1")));
    EXPECT_THAT(notices, testing::Contains(testing::HasSubstr("left out, objects: 2")));
}

TEST(GlbExport, AFloatTextureInAMaterialIsLeftOutAndReported) {
    RichScene rich;
    make_rich(rich);
    scene::Material material;
    for (const auto& [id, object] : rich.scene.objects()) {
        const auto* found = std::get_if<scene::Material>(object.get());
        if (found == nullptr) continue;
        material = *found;
        for (const auto& [texture, candidate] : rich.scene.objects()) {
            if (scene::name(*candidate) == "sky") material.emission_texture = {.texture = texture};
        }
        ASSERT_TRUE(rich.scene.apply_entries({scene::Update{
            id, scene::Fields<scene::Material>(&scene::Material::emission_texture).bits(), material}}));
        break;
    }
    Notices notices;
    const import::ImportedScene imported = through_glb(rich.scene, rich.blobs, notices);
    EXPECT_THAT(notices, testing::Contains(testing::HasSubstr("texture 'sky' is left out")));
    EXPECT_FALSE(import::named<scene::Material>(imported, material.name).emission_texture.texture);
}

// Data of 16 bits (imported as floats) is written as such.
TEST(GlbExport, AFloatTextureWithinOneIsWrittenWithSixteenBits) {
    RichScene rich;
    make_rich(rich);
    const std::vector<float> values{0.25f, 0.5f, 1.0f};
    const scene::BlobPtr texels = rich.blobs.insert(std::as_bytes(std::span(values)));
    const scene::Texture precise{.name = "precise",
                                 .width = 1,
                                 .height = 1,
                                 .format = scene::TexelFormat::RgbFloat,
                                 .texels = scene::reference(*texels)};
    const ObjectId id{1000};
    ASSERT_TRUE(rich.scene.apply_entries({scene::Create{id, precise}}));
    std::string changed;
    for (const auto& [other, object] : rich.scene.objects()) {
        const auto* found = std::get_if<scene::Material>(object.get());
        if (found == nullptr || !changed.empty()) continue;
        scene::Material material = *found;
        changed = material.name;
        material.normal_texture = {.texture = id};
        ASSERT_TRUE(rich.scene.apply_entries({scene::Update{
            other, scene::Fields<scene::Material>(&scene::Material::normal_texture).bits(), material}}));
    }
    Notices notices;
    const import::ImportedScene imported = through_glb(rich.scene, rich.blobs, notices);
    const auto& again = import::named<scene::Texture>(imported, "precise");
    EXPECT_EQ(again.format, scene::TexelFormat::RgbFloat);
    const auto found = import::values<float>(imported, again.texels);
    ASSERT_EQ(found.size(), 3u);
    EXPECT_NEAR(found[0], 0.25f, 1.0f / 65535.0f);
    EXPECT_NEAR(found[1], 0.5f, 1.0f / 65535.0f);
    EXPECT_EQ(found[2], 1.0f);
}

TEST(GlbExport, NamesWithInvalidUtf8AreRepaired) {
    RichScene rich;
    make_rich(rich);
    scene::Transform odd{.name = "a\xff\xc0z"};
    odd.children = rich.scene.find_as<scene::Root>(scene::RootId)->children;
    scene::Root root = *rich.scene.find_as<scene::Root>(scene::RootId);
    root.children = {ObjectId{900}};
    ASSERT_TRUE(rich.scene.apply_entries(
        {scene::Create{ObjectId{900}, odd},
         scene::Update{scene::RootId, scene::Fields<scene::Root>(&scene::Root::children).bits(), root}}));
    Notices notices;
    const import::ImportedScene imported = through_glb(rich.scene, rich.blobs, notices);
    import::named<scene::Transform>(imported, "a\xef\xbf\xbd\xef\xbf\xbdz");
}

}  // namespace
}  // namespace tessera::exporting
