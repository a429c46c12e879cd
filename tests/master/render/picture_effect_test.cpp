// Which edits restart accumulation: every field of every kind of object.
#include "master/render/picture_effect.h"

#include <gtest/gtest.h>

#include <set>

#include "mediator/scene/fields.h"

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
            EXPECT_EQ(changes_pictures(list_of(Update{ObjectId{id}, field_bit(field), object}), scene),
                      !is_silent)
                << name;
        }
    }
}

TEST(PictureEffect, TransformOfACameraHasNoEffect) {
    const Scene scene = some_scene();
    const Update move{ObjectId{20}, Fields<Transform>(&Transform::matrix).bits(), Transform{}};
    EXPECT_FALSE(changes_pictures(list_of(move), scene));
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
    EXPECT_FALSE(changes_pictures(at(1000), deep));
    ASSERT_TRUE(deep.apply_entries({Create{ObjectId{10}, Light{}},
                                    Update{ObjectId{201'000}, Fields<Transform>(&Transform::children).bits(),
                                           Transform{.children = {ObjectId{10}}}}}));
    EXPECT_TRUE(changes_pictures(at(1000), deep));
    EXPECT_FALSE(changes_pictures(at(1000), chain(64, 2)));
}

TEST(PictureEffect, AddedAndRemovedObjectsShowAsChangesOfReferences) {
    const Scene scene = some_scene();
    EXPECT_FALSE(changes_pictures(list_of(Create{ObjectId{30}, Material{}}), scene));
    EXPECT_FALSE(changes_pictures(list_of(Remove{ObjectId{30}}), scene));
    EXPECT_FALSE(changes_pictures({.from = {1, 1}, .to = {1, 2}, .entries = {}, .state_hash = {}}, scene));
    EXPECT_TRUE(changes_pictures(snapshot(scene), scene)) << "a snapshot is anything";
}

}  // namespace
}  // namespace tessera::master
