// Files and hashes of the first release, readable as long as the format version is 1. In `recorded/`, each
// field of each kind differs from its initial value in at least one object; every_update.changes gives
// objects with initial values the same values.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "client/import/tessera_format.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/validate.h"
#include "mediator/wire/envelope.h"

namespace tessera::exporting {
namespace {

const std::filesystem::path Recorded = TESSERA_RECORDED;

constexpr Hash128 PlainHash{0x95af7cef243ee9ea, 0x14fe00987b726965};
constexpr Hash128 RichHash{0x58a0fbdcf90cf02c, 0x85070d416a3240d5};
constexpr Hash128 OddHash{0x4df811e5aca5315d, 0xa1b67de8c0dc351f};

scene::Scene rich() {
    const auto file = import::read_tessera(Recorded / "every_field.tessera");
    EXPECT_TRUE(file) << file.error().what();
    scene::Scene scene;
    EXPECT_TRUE(file && scene.apply(file->snapshot));
    return scene;
}

// As files had it before maps had another direction.
template <class T>
scene::Object initial_object() {
    T object{};
    if constexpr (std::is_same_v<T, scene::Background>) object.map_center = scene::MapCenter::NegativeZ;
    return object;
}

// The same objects with their initial values.
scene::Scene plain() {
    std::vector<scene::Entry> entries;
    const scene::Scene full = rich();
    for (const auto& [id, object] : full.objects()) {
        entries.push_back(
            scene::Create{id, std::visit([]<class T>(const T&) { return initial_object<T>(); }, *object)});
    }
    scene::Scene scene;
    EXPECT_TRUE(scene.apply_entries(entries));
    scene.set_version({77, 11});
    return scene;
}

TEST(Recorded, FilesAreReadWithTheirHash) {
    const scene::Scene scene = rich();
    EXPECT_EQ(scene.state_hash(), RichHash);
    EXPECT_EQ(scene.version(), (Version{77, 12}));
    EXPECT_TRUE(scene::validate(scene).empty());
    EXPECT_EQ(plain().state_hash(), PlainHash);
}

TEST(Recorded, UpdatesOfAllFieldsAreRead) {
    std::ifstream in(Recorded / "every_update.changes", std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto changes = wire::decode_change_list(std::as_bytes(std::span(text)));
    ASSERT_TRUE(changes) << changes.error().what();
    scene::Scene scene = plain();
    ASSERT_TRUE(scene.apply(*changes));
    EXPECT_EQ(scene.state_hash(), OddHash);
    const auto& material = *scene.find_as<scene::Material>(ObjectId{5});
    EXPECT_TRUE(std::signbit(material.roughness)) << "-0 is not 0";
    EXPECT_EQ(material.base_color.r, 1e-42f);

    const auto again = wire::decode_change_list(wire::encode(*changes));
    ASSERT_TRUE(again);
    scene = plain();
    ASSERT_TRUE(scene.apply(*again)) << "written and read once more";
    EXPECT_EQ(scene.state_hash(), OddHash);
}

}  // namespace
}  // namespace tessera::exporting
