// Configuration of parts and materials.
#include "client/import/configure.h"

#include <gtest/gtest.h>

#include "tests/import/inspect.h"
#include "tests/support/folders.h"

namespace tessera::import {
namespace {

std::string material_of(const ImportedScene& scene, const std::string& part) {
    std::map<ObjectId, std::string> names;
    ObjectId material;
    const auto note = [&](const auto& self, ObjectId id, bool inside) -> void {
        for (const scene::Create& entry : scene.objects) {
            if (entry.id != id) continue;
            if (const auto* transform = std::get_if<scene::Transform>(&entry.object)) {
                for (const ObjectId child : transform->children)
                    self(self, child, inside || transform->name == part);
            }
            if (const auto* geometry = std::get_if<scene::Geometry>(&entry.object)) {
                if (inside || geometry->name == part) material = geometry->material;
            }
        }
    };
    for (const ObjectId child : scene.root.children) note(note, child, false);
    for (const scene::Create& entry : scene.objects) {
        if (const auto* found = std::get_if<scene::Material>(&entry.object)) names[entry.id] = found->name;
    }
    return names[material];
}

TEST(Configure, PaintsAPartWithAMaterialOfTheFile) {
    ImportedScene scene = loaded(test::scenes_folder() / "still.glb");
    std::string part;
    for (const scene::Create& entry : scene.objects) {
        const auto* geometry = std::get_if<scene::Geometry>(&entry.object);
        if (geometry != nullptr && part.empty() && !geometry->name.empty()) part = geometry->name;
    }
    ASSERT_FALSE(part.empty());
    ASSERT_TRUE(configure(scene, {.materials = {{part, "copper"}}}));
    EXPECT_EQ(material_of(scene, part), "copper");
    ASSERT_TRUE(configure(scene, {.materials = {{part, "clay"}}}));
    EXPECT_EQ(material_of(scene, part), "clay");
}

TEST(Configure, HiddenPartsAreNoLongerPlaced) {
    ImportedScene scene = loaded(test::scenes_folder() / "still.glb");
    std::string part;
    for (const scene::Create& entry : scene.objects) {
        const auto* transform = std::get_if<scene::Transform>(&entry.object);
        if (transform != nullptr && part.empty() && !transform->name.empty()) part = transform->name;
    }
    ASSERT_FALSE(part.empty());
    EXPECT_NE(material_of(scene, part), "");
    ASSERT_TRUE(configure(scene, {.hidden = {part}}));
    EXPECT_EQ(material_of(scene, part), "");
}

TEST(Configure, UnknownNamesAreErrorsThatListTheNames) {
    ImportedScene scene = loaded(test::scenes_folder() / "still.glb");
    const auto message = [&](const Configuration& configuration) {
        const auto done = configure(scene, configuration);
        return done ? std::string("accepted") : std::string(done.error().what());
    };
    EXPECT_NE(message({.hidden = {"no such part"}}).find("the parts are"), std::string::npos);
    EXPECT_NE(message({.materials = {{"no such part", "copper"}}}).find("the parts are"), std::string::npos);
    EXPECT_NE(message({.materials = {{"table", "velvet"}}}).find("copper"), std::string::npos);
    EXPECT_NE(message({.hidden = {""}}), "accepted");
}

}  // namespace
}  // namespace tessera::import
