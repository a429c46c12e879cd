#pragma once

#include <gtest/gtest.h>

#include "master/scene/scene_authority.h"
#include "mediator/scene/fields.h"

namespace tessera::master {

// An authority with members who edit by name.
struct AuthorityFixture : testing::Test {
    struct Member {
        SessionId session;
        std::string name;
        IdRange ids;
        std::uint64_t sequence = 0;
        ObjectId id(std::uint64_t i) const { return ObjectId{ids.first + i}; }
    };

    Member join(std::uint64_t session, const std::string& name) {
        Member member{SessionId{session}, name, {}};
        member.ids = authority.join(member.session, name, session + 1000);
        member.sequence = authority.last_sequence(member.session);
        return member;
    }

    EditAnswer send(Member& member, scene::Edit edit) {
        edit.session = member.session;
        edit.sequence = ++member.sequence;
        return authority.submit(edit, {member.name, member.name + "'s key", ++clock});
    }
    EditAnswer edit(Member& member, std::vector<scene::Entry> entries, std::uint64_t edit_group = 0) {
        return send(member, {.entries = std::move(entries), .edit_group = edit_group});
    }
    EditAnswer undo(Member& member, std::uint64_t number) { return send(member, {.undo = number}); }

    // An edit that the test needs: fails it where it is refused.
    std::uint64_t must(const EditAnswer& answer) {
        EXPECT_TRUE(answer.accepted) << (answer.problems.empty() ? "" : answer.problems[0]);
        return answer.transaction;
    }

    template <class T>
    static scene::Entry set(ObjectId id, scene::Fields<T> fields, const T& value) {
        return scene::Update{id, fields.bits(), value};
    }
    static scene::Entry roughness(ObjectId id, float value) {
        return set<scene::Material>(id, &scene::Material::roughness, {.roughness = value});
    }
    static scene::Entry metallic(ObjectId id, float value) {
        return set<scene::Material>(id, &scene::Material::metallic, {.metallic = value});
    }
    static scene::Entry root_children(std::vector<ObjectId> list) {
        return set<scene::Root>(scene::RootId, &scene::Root::children, {.children = std::move(list)});
    }
    const std::vector<ObjectId>& root_children() const {
        return authority.scene().find_as<scene::Root>(scene::RootId)->children;
    }
    const scene::Material& material(ObjectId id) const {
        return *authority.scene().find_as<scene::Material>(id);
    }

    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    SceneAuthority authority{42, blobs};
    std::int64_t clock = 0;
};

}  // namespace tessera::master
