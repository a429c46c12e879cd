#include "mediator/scene/validate.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "mediator/scene/fields.h"
#include "mediator/scene/inverse.h"
#include "mediator/scene/referrers.h"

namespace tessera::scene {
namespace {

constexpr double NaN = std::numeric_limits<double>::quiet_NaN();
constexpr ObjectId A{100}, B{101}, C{102};

// Problems of a scene that holds a root and these.
std::vector<Problem> problems(std::vector<Entry> entries) {
    Scene scene;
    entries.push_back(Create{RootId, Root{}});
    EXPECT_TRUE(scene.apply_entries(entries));
    const auto all = validate(scene);
    // What an edit is checked by finds as much as the check of everything.
    EXPECT_EQ(validate_entries(scene, entries).empty(), all.empty());
    return all;
}

template <class T>
bool is_refused(T object) {
    return !problems({Create{A, std::move(object)}}).empty();
}

TEST(Validate, AcceptsValidScenes) {
    EXPECT_TRUE(
        problems({Create{A, Transform{.children = {B}}}, Create{B, Light{}}, Create{C, Material{}}}).empty());
}

TEST(Validate, RequiresFiniteAffineTransforms) {
    Transform transform;
    transform.matrix[3][0] = NaN;
    EXPECT_TRUE(is_refused(transform));
    transform = {};
    transform.matrix[0][3] = 0.5;
    EXPECT_TRUE(is_refused(transform)) << "perspective in a transform";
    transform = {};
    transform.matrix[3][1] = 1e16;
    EXPECT_TRUE(is_refused(transform));
}

TEST(Validate, RequiresNumbersInTheirRanges) {
    EXPECT_TRUE(is_refused(Material{.roughness = -0.1f}));
    EXPECT_TRUE(is_refused(Material{.metallic = std::numeric_limits<float>::quiet_NaN()}));
    EXPECT_TRUE(is_refused(Material{.emission = glm::vec3(std::numeric_limits<float>::infinity())}));
    EXPECT_TRUE(is_refused(Material{.index_of_refraction = 0.5f}));
    EXPECT_TRUE(
        is_refused(Light{.kind = LightKind::Spot, .inner_cone_angle = 1.0f, .outer_cone_angle = 0.5f}));
    EXPECT_TRUE(is_refused(Light{.kind = static_cast<LightKind>(17)}));
    EXPECT_TRUE(is_refused(Camera{.vertical_fov = 0.0}));
    EXPECT_TRUE(is_refused(Texture{.width = 2, .height = 2, .texels = {{}, 15}}));
    EXPECT_TRUE(is_refused(Background{.color = glm::vec3(-1.0f)}));
    EXPECT_TRUE(is_refused(Geometry{.indices = {{}, 11}, .positions = {{}, 36}}));
    EXPECT_TRUE(is_refused(Geometry{.indices = {{}, 12}, .positions = {{}, 36}, .normals = {{}, 24}}));
}

TEST(Validate, RequiresValidReferences) {
    EXPECT_TRUE(is_refused(Transform{.children = {ObjectId{999}}}));
    EXPECT_FALSE(problems({Create{A, Transform{.children = {B}}}, Create{B, Material{}}}).empty());
    EXPECT_FALSE(problems({Create{A, Geometry{.material = B, .indices = {{}, 12}, .positions = {{}, 36}}},
                           Create{B, Light{}}})
                     .empty());
    Scene scene;
    ASSERT_TRUE(scene.apply_entries(
        {Create{RootId, Root{}}, Create{A, Transform{.children = {B}}}, Create{B, Light{}}}));
    ASSERT_TRUE(scene.apply_entries({Remove{B}}));
    EXPECT_FALSE(validate_entries(scene, {Remove{B}}).empty()) << "an object still refers to it";
}

TEST(Validate, RequiresAFewFiniteMotionKeys) {
    Transform moving{.motion = std::vector<glm::dmat4>(MaxMotion, glm::dmat4(1.0))};
    EXPECT_FALSE(is_refused(moving));
    moving.motion[14][3][1] = NaN;
    EXPECT_TRUE(is_refused(moving));
    moving.motion[14] = glm::dmat4(1.0);
    moving.motion[14][1][3] = 0.5;
    EXPECT_TRUE(is_refused(moving)) << "perspective";
    moving.motion.assign(MaxMotion + 1, glm::dmat4(1.0));
    EXPECT_TRUE(is_refused(moving));

    Geometry deformed{.indices = {{}, 12}, .positions = {{}, 36}, .normals = {{}, 36}};
    deformed.motion_positions.assign(MaxMotion, BlobRef{{}, 36});
    EXPECT_FALSE(is_refused(deformed));
    deformed.motion_normals.assign(MaxMotion, BlobRef{{}, 36});
    EXPECT_FALSE(is_refused(deformed));
    Geometry without = deformed;
    without.normals = {};
    EXPECT_TRUE(is_refused(without)) << "no normals to begin with";
    deformed.motion_normals.pop_back();
    EXPECT_TRUE(is_refused(deformed)) << "fewer motion keys of normals than of positions";
    deformed.motion_normals.clear();
    deformed.motion_positions[3].byte_size = 24;
    EXPECT_TRUE(is_refused(deformed)) << "fewer vertices";
    deformed.motion_positions[3].byte_size = 0;
    EXPECT_TRUE(is_refused(deformed));
    deformed.motion_positions.assign(MaxMotion + 1, BlobRef{{}, 36});
    EXPECT_TRUE(is_refused(deformed));
}

TEST(Validate, AllowsVolumeTexturesOnlyForMedia) {
    const Texture volume{.width = 2, .height = 2, .texels = {{}, 48}, .depth = 3};
    EXPECT_FALSE(is_refused(volume));
    EXPECT_TRUE(is_refused(Texture{.width = 2, .height = 2, .texels = {{}, 16}, .depth = 3}));
    EXPECT_TRUE(is_refused(Texture{.width = 2, .height = 2, .depth = 0}));
    EXPECT_TRUE(
        problems({Create{A, Medium{.scattering_texture = {.texture = B}}}, Create{B, volume}}).empty());
    const Material material{.base_color_texture = {.texture = B}};
    EXPECT_FALSE(problems({Create{A, material}, Create{B, volume}}).empty());

    // A texture in use that becomes one.
    Scene scene;
    ReferrerIndex referrers;
    Texture flat = volume;
    flat.depth = 1;
    flat.texels.byte_size = 16;
    ASSERT_TRUE(scene.apply_entries({Create{RootId, Root{}}, Create{A, material}, Create{B, flat}}));
    for (const auto& [id, object] : scene.objects()) referrers.replace(id, nullptr, object.get());
    const std::vector<Entry> grown{
        Update{B, (Fields<Texture>(&Texture::depth) | &Texture::texels).bits(), volume}};
    const auto changes = apply_and_observe(scene, grown);
    ASSERT_TRUE(changes);
    EXPECT_FALSE(validate_entries(scene, grown).empty());
    EXPECT_FALSE(validate_changes(scene, referrers, *changes).empty());
}

TEST(Validate, FindsCyclesAtAnyDepth) {
    EXPECT_FALSE(problems({Create{A, Transform{.children = {A}}}}).empty());
    EXPECT_FALSE(problems({Create{A, Transform{.children = {B}}}, Create{B, Transform{.children = {C}}},
                           Create{C, Transform{.children = {A}}}})
                     .empty());
    std::vector<Entry> chain;
    constexpr std::uint64_t Depth = 100'000;
    for (std::uint64_t i = 0; i < Depth; ++i) {
        chain.push_back(
            Create{ObjectId{1000 + i}, Transform{.children = {ObjectId{1000 + (i + 1) % Depth}}}});
    }
    EXPECT_FALSE(problems(chain).empty());
    std::get<Transform>(std::get<Create>(chain.back()).object).children.clear();
    EXPECT_TRUE(problems(chain).empty()) << "deep alone is no cycle";
}

TEST(Validate, RequiresOneRootAndIdsThatFitAFilmPlane) {
    EXPECT_FALSE(problems({Create{A, Root{}}}).empty());
    EXPECT_FALSE(problems({Create{ObjectId{std::uint64_t{1} << 32}, Light{}}}).empty());
    EXPECT_FALSE(validate(Scene{}).empty()) << "no root at all";
}

TEST(ValidateBlobs, ChecksTheContentsOfArrays) {
    BlobStore blobs;
    const std::array<float, 9> good{0, 0, 0, 1, 0, 0, 0, 1, 0};
    std::array<float, 9> broken = good;
    broken[4] = std::numeric_limits<float>::quiet_NaN();
    const std::array<std::uint32_t, 3> inside{0, 1, 2}, outside{0, 1, 3};
    const auto put = [&](const auto& values) {
        return reference(*blobs.insert(std::as_bytes(std::span(values))));
    };
    const auto count = [&](const Geometry& geometry) { return validate_blobs(A, geometry, blobs).size(); };
    EXPECT_EQ(count({.indices = put(inside), .positions = put(good)}), 0u);
    EXPECT_EQ(count({.indices = put(outside), .positions = put(good)}), 1u);
    EXPECT_EQ(count({.indices = put(inside), .positions = put(broken)}), 1u);
    EXPECT_EQ(
        count({.indices = put(inside), .positions = put(good), .motion_positions = {put(good), put(broken)}}),
        1u);
    EXPECT_EQ(count({.indices = {blake2b({}), 12}, .positions = put(good)}), 1u)
        << "a blob that is not there";
    BlobRef longer = put(good);
    longer.byte_size = 48;
    EXPECT_GE(count({.indices = put(inside), .positions = longer}), 1u) << "a blob of another size";
}

}  // namespace
}  // namespace tessera::scene
