#include "mediator/scene/scene.h"

#include <gtest/gtest.h>

#include "mediator/scene/field_values.h"
#include "mediator/scene/fields.h"

namespace tessera::scene {
namespace {

Scene with_root() {
    Scene scene;
    EXPECT_TRUE(scene.apply_entries({Create{RootId, Root{}}}));
    scene.set_version({1, 1});
    return scene;
}

TEST(Scene, AppliesAllEntriesOfAListOrNone) {
    Scene scene = with_root();
    const Hash128 before = scene.state_hash();
    const ChangeList bad{
        .from = {1, 1}, .to = {1, 2}, .entries = {Create{ObjectId{5}, Light{}}, Remove{ObjectId{9}}}};
    EXPECT_FALSE(scene.apply(bad));
    ChangeList lying{
        .from = {1, 1}, .to = {1, 2}, .entries = {Create{ObjectId{5}, Light{}}}, .state_hash = {1, 2}};
    EXPECT_FALSE(scene.apply(lying)) << "not the hash that was promised";
    EXPECT_EQ(scene.state_hash(), before);
    EXPECT_EQ(scene.objects().size(), 1u);
    EXPECT_EQ(scene.version(), (Version{1, 1}));
    lying.from = {2, 1};
    EXPECT_FALSE(scene.apply(lying)) << "of another epoch";
}

TEST(Scene, ASnapshotReplacesEverything) {
    Scene scene = with_root(), other = with_root();
    ASSERT_TRUE(other.apply_entries({Create{ObjectId{7}, Camera{}}}));
    other.set_version({3, 9});
    ASSERT_TRUE(scene.apply_entries({Create{ObjectId{5}, Light{}}}));
    ASSERT_TRUE(scene.apply(snapshot(other)));
    EXPECT_EQ(scene.state_hash(), other.state_hash());
    EXPECT_EQ(scene.version(), other.version());
    EXPECT_EQ(scene.find(ObjectId{5}), nullptr);
}

template <class T>
void expect_every_field_counts() {
    const Object original{T{}};
    for_each_field<T>([&](unsigned bit, auto member) {
        T changed{};
        auto& value = changed.*member;
        using V = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<V, std::string>) {
            value += "x";
        } else if constexpr (std::is_same_v<V, std::vector<ObjectId>>) {
            value.push_back(ObjectId{77});
        } else if constexpr (std::is_same_v<V, std::vector<glm::dmat4>>) {
            value.push_back(glm::dmat4(1.0));
        } else if constexpr (std::is_same_v<V, std::vector<BlobRef>>) {
            value.push_back({{}, 12});
        } else if constexpr (std::is_same_v<V, ObjectId>) {
            value.value += 1;
        } else if constexpr (std::is_same_v<V, BlobRef>) {
            value.byte_size += 1;
        } else if constexpr (std::is_same_v<V, TextureSlot>) {
            value.rotation += 1.0f;
        } else if constexpr (std::is_same_v<V, glm::dmat4>) {
            value[2][1] += 1.0;
        } else if constexpr (std::is_same_v<V, bool>) {
            value = !value;
        } else if constexpr (std::is_enum_v<V>) {
            value = static_cast<V>(static_cast<int>(value) ^ 1);
        } else if constexpr (std::is_arithmetic_v<V>) {
            value += V(1);
        } else {
            value[0] += 1.0f;
        }
        const Object other{changed};
        EXPECT_EQ(differing_fields(original, other), field_bit(bit));
        EXPECT_NE(object_hash(ObjectId{5}, original), object_hash(ObjectId{5}, other))
            << name(kind(original)) << "." << field_name(kind(original), bit);
        EXPECT_FALSE(field_name(kind(original), bit).empty());
        Object assigned = original;
        assign(assigned, other, field_bit(bit));
        EXPECT_EQ(differing_fields(assigned, other), 0u);
    });
    EXPECT_NE(object_hash(ObjectId{5}, original), object_hash(ObjectId{6}, original));
}

TEST(ObjectHash, DependsOnEveryFieldOfEveryKind) {
    expect_every_field_counts<Root>();
    expect_every_field_counts<Transform>();
    expect_every_field_counts<Geometry>();
    expect_every_field_counts<Material>();
    expect_every_field_counts<Texture>();
    expect_every_field_counts<Light>();
    expect_every_field_counts<Camera>();
    expect_every_field_counts<Background>();
    expect_every_field_counts<Attachment>();
    expect_every_field_counts<SurfaceShader>();
    expect_every_field_counts<Medium>();
}

// As a kind was in the first release, and as it is with a field that came later.
struct Early {
    float size = 2.0f;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "size", &Early::size)); }
};
struct Late {
    float size = 2.0f, edge = 0.5f;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "size", &Late::size), row(2, "edge", &Late::edge, InitialWhenAbsent{}));
    }
};
struct Turned {
    float size = 2.0f, turn = 0.5f;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "size", &Turned::size), row(2, "turn", &Turned::turn, ZeroWhenAbsent{}));
    }
};

template <class T>
Hash256 hash_of(const T& value) {
    Blake2b hash;
    feed(hash, value);
    return hash.finish();
}

TEST(ObjectHash, OfOlderScenesStaysWhenAFieldIsAdded) {
    EXPECT_EQ(hash_of(Late{}), hash_of(Early{}));
    EXPECT_EQ(hash_of(Late{.size = 3.0f}), hash_of(Early{.size = 3.0f}));
    EXPECT_NE(hash_of(Late{.edge = 0.0f}), hash_of(Late{}));
    EXPECT_NE(hash_of(Late{.edge = 0.0f}), hash_of(Late{.edge = 1.0f}));
    EXPECT_EQ(hash_of(Turned{.turn = 0.0f}), hash_of(Early{}));
    EXPECT_NE(hash_of(Turned{}), hash_of(Early{}));
    EXPECT_NE(hash_of(Turned{}), hash_of(Turned{.turn = 1.0f}));
}

TEST(Masks, UseTheFieldNumberMinusOne) {
    EXPECT_EQ(Fields<Material>(&Material::base_color).bits(), 0b10u);
    EXPECT_EQ(Fields<Geometry>(&Geometry::motion_normals).bits(), field_bit(12));
    EXPECT_EQ((Fields<Root>{&Root::name, &Root::render_origin}.bits()), 0b1001u);
    EXPECT_EQ(all_fields(ObjectKind::Material), Fields<Material>::all().bits());
    EXPECT_EQ(field_name(ObjectKind::Material, 43), "shadow_catcher");
    EXPECT_EQ(field_name(ObjectKind::Material, 63), "");
}

TEST(Difference, LeadsFromOneSceneToAnother) {
    Scene a = with_root(), b = with_root();
    ASSERT_TRUE(a.apply_entries({Create{ObjectId{5}, Light{}}, Create{ObjectId{6}, Camera{}}}));
    ASSERT_TRUE(b.apply_entries({Create{ObjectId{5}, Light{.name = "other"}}, Create{ObjectId{6}, Light{}},
                                 Create{ObjectId{8}, Material{}}}));
    b.set_version({1, 2});
    ASSERT_TRUE(a.apply(difference(a, b)));
    EXPECT_EQ(a.state_hash(), b.state_hash());
}

}  // namespace
}  // namespace tessera::scene
