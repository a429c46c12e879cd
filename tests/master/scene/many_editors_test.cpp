#include "mediator/scene/validate.h"
#include "tests/master/scene/authority_fixture.h"
#include "tests/scene/random_edits.h"

namespace tessera::master {
namespace {

using namespace scene;

struct ManyEditors : AuthorityFixture {
    struct RandomMember {
        Member member;
        RandomEdits edits;
        std::uint64_t edit_group = 0, left = 0;
    };

    std::vector<RandomMember> members(std::uint64_t count, std::uint64_t seed) {
        std::vector<RandomMember> list;
        for (std::uint64_t i = 1; i <= count; ++i) {
            const Member member = join(i, "member " + std::to_string(i));
            list.push_back({member, RandomEdits(seed * 100 + i, member.ids.first)});
        }
        return list;
    }
    EditAnswer act(RandomMember& who, std::uint64_t edit_group) {
        return edit(who.member, who.edits.next(authority.scene()), edit_group);
    }
};

TEST_F(ManyEditors, ReplicasReachTheHeadVersion) {
    CounterRandom random(7);
    auto list = members(4, 1);
    Scene follower, late;
    ASSERT_TRUE(follower.apply(authority.published().snapshot()));
    ASSERT_TRUE(late.apply(authority.published().snapshot()));
    int accepted = 0, refused = 0, undone = 0;
    for (int i = 0; i < 1500; ++i) {
        RandomMember& who = list[random.below(list.size())];
        if (who.left == 0) {
            ++who.edit_group;
            who.left = 1 + random.below(5);
        }
        --who.left;
        EditAnswer answer;
        const std::uint64_t dice = random.below(20);
        if (dice == 0) {
            answer = undo(who.member, UndoLatest);
            undone += answer.accepted;
        } else if (dice == 1) {
            answer = undo(who.member, RedoLatest);
        } else if (dice == 2) {
            answer = undo(who.member, 1 + random.below(authority.transactions() + 1));
        } else if (dice == 3) {
            answer = edit(who.member, who.edits.impossible(authority.scene()));
        } else {
            answer = act(who, who.edit_group);
        }
        (answer.accepted ? accepted : refused) += 1;
        EXPECT_EQ(answer.problems.empty(), answer.accepted);
        const Hash128 head = authority.scene().state_hash();
        const Version pending = authority.pending();
        if (random.below(3) != 0) continue;
        const auto changes = authority.publish();
        if (!changes) continue;
        ASSERT_EQ(changes->to, pending);
        const auto applied = follower.apply(*changes);
        ASSERT_TRUE(applied) << applied.error().what();
        ASSERT_EQ(follower.state_hash(), head);
        ASSERT_TRUE(validate(follower).empty());
        if (random.below(10) != 0) continue;
        const auto catch_up = authority.published().since(late.version());
        ASSERT_TRUE(catch_up);
        const auto caught_up = late.apply(catch_up->list());
        ASSERT_TRUE(caught_up) << caught_up.error().what();
        ASSERT_TRUE(difference(late, follower).entries.empty());
    }
    EXPECT_GT(accepted, 1000);
    EXPECT_GT(refused, 50);
    EXPECT_GT(undone, 20);
}

TEST_F(ManyEditors, SnapshotsAndCatchingUpHoldWhatIsPublishedOnly) {
    auto list = members(2, 2);
    Scene replica, early;
    ASSERT_TRUE(early.apply(authority.published().snapshot()));
    for (int i = 0; i < 40; ++i) act(list[static_cast<std::size_t>(i) % 2], 0);
    authority.publish();
    const Version published = authority.version();
    ASSERT_TRUE(replica.apply(authority.published().snapshot()));
    for (int i = 0; i < 40; ++i) {
        act(list[static_cast<std::size_t>(i) % 2], 0);
        Scene joined;
        const auto snapshot = authority.published().snapshot();
        ASSERT_TRUE(joined.apply(snapshot)) << "its hash is its own";
        ASSERT_TRUE(difference(replica, joined).entries.empty());
        ASSERT_EQ(joined.version(), published);
        ASSERT_TRUE(authority.published().since(published));
        EXPECT_TRUE(authority.published().since(published)->list().entries.empty());
        Scene caught_up = early;
        ASSERT_TRUE(caught_up.apply(authority.published().since(early.version())->list()));
        ASSERT_TRUE(difference(replica, caught_up).entries.empty());
    }
    ASSERT_TRUE(authority.has_unpublished());
    EXPECT_NE(authority.scene().state_hash(), replica.state_hash());
    EXPECT_EQ(authority.published().state_hash(), replica.state_hash());
}

TEST_F(ManyEditors, UnknownVersionsAreRejected) {
    EXPECT_TRUE(authority.published().since({42, 1}));
    EXPECT_FALSE(authority.published().since({42, 0}));
    EXPECT_FALSE(authority.published().since({42, 2})) << "not published yet";
    EXPECT_FALSE(authority.published().since({41, 1})) << "of a master before";
}

TEST_F(ManyEditors, UndoingEverythingInReverseOrderLeadsBackToTheStart) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        authority = SceneAuthority(43 + seed, blobs);
        CounterRandom random(seed, 5);
        auto list = members(3, seed);
        const Hash128 start = authority.scene().state_hash();
        while (authority.transactions() < 120) {
            RandomMember& who = list[random.below(list.size())];
            ++who.edit_group;
            for (std::uint64_t drag = random.below(4); drag > 0; --drag) act(who, who.edit_group);
            act(who, 0);
        }
        EXPECT_GT(authority.scene().objects().size(), 10u);
        for (std::uint64_t number = authority.transactions(); number > 0; --number) {
            const auto answer = undo(list[random.below(list.size())].member, number);
            ASSERT_TRUE(answer.accepted) << answer.problems.at(0);
            ASSERT_TRUE(answer.notes.empty()) << answer.notes.at(0);
        }
        EXPECT_EQ(authority.scene().state_hash(), start) << "seed " << seed;
        const auto list_of_all = authority.publish();
        ASSERT_TRUE(list_of_all);
        EXPECT_TRUE(list_of_all->entries.empty()) << "one version in which nothing happened in the end";
    }
}

TEST_F(ManyEditors, PublishCombinesEdits) {
    Member anna = join(1, "anna");
    const ObjectId lamp = anna.id(0), red = anna.id(1);
    must(edit(anna, {Create{red, Material{}}}));
    authority.publish();
    must(edit(anna, {Create{lamp, Light{}}}));
    must(edit(anna, {roughness(red, 0.5f)}));
    must(edit(anna, {roughness(red, 0.25f)}));
    must(edit(anna, {metallic(red, 0.5f)}));
    must(edit(anna, {Remove{lamp}}));
    const auto changes = authority.publish();
    ASSERT_TRUE(changes);
    ASSERT_EQ(changes->entries.size(), 1u) << "the lamp came and went";
    const auto& update = std::get<Update>(changes->entries[0]);
    EXPECT_EQ(update.mask, (Fields<Material>{&Material::roughness, &Material::metallic}.bits()));
    EXPECT_FALSE(authority.has_unpublished());
    EXPECT_FALSE(authority.publish());
}

}  // namespace
}  // namespace tessera::master
