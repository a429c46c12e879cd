#include "master/scene/session_log.h"

#include "master/scene/checkpoint_writer.h"
#include "tests/master/scene/session_fixture.h"

namespace tessera::master {
namespace {

using namespace scene;

struct SessionLogTest : SessionFixture {
    void edit(SceneAuthority& authority, std::vector<Entry> entries, std::uint64_t edit_group = 0) {
        const auto answer = authority.submit({.session = session(0),
                                              .sequence = authority.last_sequence(session(0)) + 1,
                                              .entries = std::move(entries),
                                              .edit_group = edit_group},
                                             {"anna", "anna's key", ++time});
        ASSERT_TRUE(answer.accepted);
    }
    Entry roughness(ObjectId id, float value) {
        return Update{id, Fields<Material>(&Material::roughness).bits(), Material{.roughness = value}};
    }
    std::int64_t time = 0;
};

TEST_F(SessionLogTest, ListsTransactionsWhileTheMasterRuns) {
    auto master = start(1);
    join_all(master->authority);
    const ObjectId red{master->authority.join(session(0), "user 0", 100).first};
    const ObjectId lamp{red.value + 1};
    edit(master->authority, {Create{red, Material{.name = "red"}}});
    edit(master->authority, {Create{lamp, Light{.name = "lamp"}}});
    CheckpointWriter writer(folder);
    writer.start({master->journal->start_segment(), {}, master->authority.save(), {}});
    writer.wait();
    for (int i = 1; i <= 5; ++i) edit(master->authority, {roughness(red, 0.1f * static_cast<float>(i))}, 7);
    std::ofstream(journal_path(folder, 2), std::ios::binary | std::ios::app) << "being wr";

    const SessionLog all = read_session_log(folder, "");
    EXPECT_TRUE(all.notes.empty());
    ASSERT_EQ(all.transactions.size(), 3u) << "each once, though the checkpoint has some, too";
    EXPECT_EQ(all.transactions[0].text, "created materials/red");
    EXPECT_EQ(all.transactions[0].name, "anna");
    EXPECT_EQ(all.transactions[0].user, "anna's key");
    EXPECT_EQ(all.transactions[0].edits, 1u);
    EXPECT_EQ(all.transactions[2].edits, 5u);
    EXPECT_EQ(all.transactions[2].time, 7);
    EXPECT_EQ(read_session_log(folder, "materials/red").transactions.size(), 2u);
    EXPECT_EQ(read_session_log(folder, std::to_string(lamp.value)).transactions.size(), 1u);
    EXPECT_TRUE(read_session_log(folder, "materials/blue").transactions.empty());
    EXPECT_THROW(read_session_log(folder / "nowhere", ""), Error);
}

}  // namespace
}  // namespace tessera::master
