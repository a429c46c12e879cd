// Which edits restart accumulation: every field of every kind of object.
#include "master/render/picture_effect.h"

#include <gtest/gtest.h>

#include <set>

#include "mediator/scene/fields.h"
#include "tests/support/cpu_time.h"

namespace tessera::master {
namespace {

using namespace scene;

// Root - transform - (geometry, camera, attachment) and a transform with only a camera.
Scene some_scene() {
    Scene scene;
    EXPECT_TRUE(scene.apply_entries(
        {Create{RootId, Root{.children = {ObjectId{10}, ObjectId{20}}}},
         Create{ObjectId{10}, Transform{.children = {ObjectId{11}, ObjectId{12}}}},
         Create{ObjectId{11}, Geometry{.material = ObjectId{13}}}, Create{ObjectId{12}, Camera{}},
         Create{ObjectId{13}, Material{}}, Create{ObjectId{14}, Texture{}}, Create{ObjectId{15}, Light{}},
         Create{ObjectId{16}, Background{}}, Create{ObjectId{17}, Attachment{}},
         Create{ObjectId{20}, Transform{.children = {ObjectId{12}}}}}));
    return scene;
}

ChangeList list_of(Entry entry) {
    return {.from = {1, 1}, .to = {1, 2}, .entries = {std::move(entry)}, .state_hash = {}};
}

TEST(PictureEffect, EveryFieldOfEveryKind) {
    const Scene scene = some_scene();
    const std::set<std::string> silent{"root.name",       "transform.name", "transform.hint",
                                       "geometry.name",   "geometry.hint",  "material.name",
                                       "texture.name",    "light.name",     "background.name",
                                       "attachment.name", "attachment.key", "attachment.value"};
    for (const std::uint64_t id : {1u, 10u, 11u, 12u, 13u, 14u, 15u, 16u, 17u}) {
        const Object& object = *scene.find(ObjectId{id});
        for (unsigned field = 0; (all_fields(object) >> field) != 0; ++field) {
            const std::string name =
                std::string(scene::name(kind(object))) + "." + std::string(field_name(kind(object), field));
            // A view copies the camera's values.
            const bool is_silent = silent.contains(name) || std::holds_alternative<Camera>(object);
            EXPECT_EQ(picture_effect(list_of(Update{ObjectId{id}, field_bit(field), object}), scene).samples,
                      !is_silent)
                << name;
        }
    }
}

// What temporal filters may still trust.
TEST(PictureEffect, SeparatesLightFromShape) {
    const Scene scene = some_scene();
    const auto effect = [&](std::uint64_t id, auto field) {
        const Object& object = *scene.find(ObjectId{id});
        return picture_effect(list_of(Update{ObjectId{id}, field.bits(), object}), scene);
    };
    const auto expect = [](const PictureEffect& effect, bool light, bool shape) {
        EXPECT_TRUE(effect.samples);
        EXPECT_EQ(effect.lights_or_materials, light);
        EXPECT_EQ(effect.geometry, shape);
    };
    expect(effect(10, Fields<Transform>(&Transform::matrix)), false, true);
    expect(effect(11, Fields<Geometry>(&Geometry::positions)), false, true);
    expect(effect(11, Fields<Geometry>(&Geometry::material)), true, false);
    expect(effect(13, Fields<Material>(&Material::base_color)), true, false);
    expect(effect(14, Fields<Texture>(&Texture::texels)), true, false);
    expect(effect(15, Fields<Light>(&Light::intensity)), true, false);
    expect(effect(1, Fields<Root>(&Root::background)), true, false);
    expect(effect(10, Fields<Transform>(&Transform::children)), true, true);  // a lamp may have left
}

TEST(PictureEffect, MovedLampsChangeTheLight) {
    Scene scene = some_scene();
    const auto moved = [&](std::uint64_t id) {
        return picture_effect(
            list_of(Update{ObjectId{id}, Fields<Transform>(&Transform::matrix).bits(), Transform{}}), scene);
    };
    ASSERT_TRUE(scene.apply_entries({Update{ObjectId{20}, Fields<Transform>(&Transform::children).bits(),
                                            Transform{.children = {ObjectId{15}}}}}));
    EXPECT_TRUE(moved(20).lights_or_materials);
    EXPECT_FALSE(moved(20).geometry) << "a light alone has no surface";
    EXPECT_FALSE(moved(10).lights_or_materials);
    ASSERT_TRUE(scene.apply_entries({Update{ObjectId{13}, Fields<Material>(&Material::emission).bits(),
                                            Material{.emission = glm::vec3(1.0f)}}}));
    EXPECT_TRUE(moved(10).lights_or_materials && moved(10).geometry) << "its geometry shines";
}

TEST(PictureEffect, LargePartsAreTakenToContainALight) {
    Scene scene;
    std::vector<Entry> entries{Create{RootId, Root{.children = {ObjectId{10}}}}};
    Transform parts;
    for (std::uint64_t id = 100; id < 100'100; ++id) {
        parts.children.push_back(ObjectId{id});
        entries.emplace_back(Create{ObjectId{id}, Geometry{}});
    }
    entries.emplace_back(Create{ObjectId{10}, parts});
    const double start = test::thread_cpu_seconds();
    ASSERT_TRUE(scene.apply_entries(entries));
    const double applying = test::thread_cpu_seconds() - start;
    const auto changes =
        list_of(Update{ObjectId{10}, Fields<Transform>(&Transform::matrix).bits(), Transform{}});
    const double before = test::thread_cpu_seconds();
    const PictureEffect effect = picture_effect(changes, scene);
    const double looking = test::thread_cpu_seconds() - before;
    EXPECT_TRUE(effect.geometry && effect.lights_or_materials);
    RecordProperty("share", std::to_string(looking / applying));
    if (!test::IsSanitized) {
        EXPECT_LT(looking, 0.02 * applying) << "on the loop of a master";
    }
}

TEST(PictureEffect, TransformOfACameraHasNoEffect) {
    const Scene scene = some_scene();
    const Update move{ObjectId{20}, Fields<Transform>(&Transform::matrix).bits(), Transform{}};
    EXPECT_FALSE(picture_effect(list_of(move), scene).samples);
}

// One by one, 2^64 placements would never end; with recursion, a long chain would end the process.
TEST(PictureEffect, DeepAndSharedTransforms) {
    const auto chain = [](std::uint64_t depth, std::size_t copies) {
        std::vector<Entry> entries{Create{RootId, Root{.children = {ObjectId{1000}}}}};
        for (std::uint64_t id = 1000; id < 1000 + depth; ++id)
            entries.emplace_back(
                Create{ObjectId{id}, Transform{.children = std::vector(copies, ObjectId{id + 1})}});
        entries.emplace_back(Create{ObjectId{1000 + depth}, Transform{}});
        Scene scene;
        EXPECT_TRUE(scene.apply_entries(entries));
        return scene;
    };
    const auto at = [](std::uint64_t id) {
        return list_of(Update{ObjectId{id}, Fields<Transform>(&Transform::matrix).bits(), Transform{}});
    };
    Scene deep = chain(200'000, 1);
    EXPECT_FALSE(picture_effect(at(1000), deep).samples);
    ASSERT_TRUE(deep.apply_entries({Create{ObjectId{10}, Light{}},
                                    Update{ObjectId{201'000}, Fields<Transform>(&Transform::children).bits(),
                                           Transform{.children = {ObjectId{10}}}}}));
    EXPECT_TRUE(picture_effect(at(1000), deep).samples);
    EXPECT_FALSE(picture_effect(at(1000), chain(64, 2)).samples);
}

TEST(PictureEffect, AddedAndRemovedObjectsShowAsChangesOfReferences) {
    const Scene scene = some_scene();
    EXPECT_FALSE(picture_effect(list_of(Create{ObjectId{30}, Material{}}), scene).samples);
    EXPECT_FALSE(picture_effect(list_of(Remove{ObjectId{30}}), scene).samples);
    EXPECT_FALSE(
        picture_effect({.from = {1, 1}, .to = {1, 2}, .entries = {}, .state_hash = {}}, scene).samples);
    const PictureEffect of_snapshot = picture_effect(snapshot(scene), scene);
    EXPECT_TRUE(of_snapshot.samples && of_snapshot.lights_or_materials && of_snapshot.geometry)
        << "a snapshot is anything";
}

}  // namespace
}  // namespace tessera::master
