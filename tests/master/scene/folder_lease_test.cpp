// Two masters on one session folder, where locks do not reach from one machine to the other.
#include "master/scene/folder_lease.h"

#include <thread>

#include "master/scene/checkpoint_writer.h"
#include "tests/master/scene/session_fixture.h"

namespace tessera::master {
namespace {

struct FolderLeaseTest : SessionFixture {
    const fs::path owner = folder / "owner";
    static constexpr const char* Other = "0123abcd\nelsewhere\n77\n";

    static std::string start_problem(const fs::path& folder) {
        try {
            const SessionFolder taken(folder);
            return {};
        } catch (const Error& error) {
            return error.what();
        }
    }
    void make_old(std::chrono::seconds age) const {
        fs::last_write_time(owner, fs::file_time_type::clock::now() - age);
    }
};

TEST_F(FolderLeaseTest, IsGivenBackAtTheEnd) {
    {
        const SessionFolder taken(folder);
        EXPECT_TRUE(fs::exists(owner));
        EXPECT_EQ(taken.lease()->problem(), "");
    }
    EXPECT_FALSE(fs::exists(owner));
}

TEST_F(FolderLeaseTest, AFolderThatAMasterElsewhereRefreshesIsRefused) {
    fs::create_directories(folder);
    write(owner, Other);
    const std::string problem = start_problem(folder);
    EXPECT_TRUE(problem.starts_with("the master on elsewhere (process 77) uses the session folder"))
        << problem;
    EXPECT_NE(problem.find("try again in 30 s"), std::string::npos) << problem;
    EXPECT_EQ(read(owner), Other) << "it stays its folder";
    make_old(std::chrono::seconds(31));
    EXPECT_EQ(start_problem(folder), "") << "it is gone";
}

// It may have been killed, and its lock went with it.
TEST_F(FolderLeaseTest, AFolderOfThisMachineIsTakenAtOnce) {
    std::string content;
    {
        const SessionFolder taken(folder);
        content = read(owner);
    }
    write(owner, content);
    EXPECT_EQ(start_problem(folder), "");
}

TEST_F(FolderLeaseTest, IsRefreshed) {
    fs::create_directories(folder);
    FolderLease lease(folder, {.refresh = std::chrono::milliseconds(20)});
    make_old(std::chrono::hours(1));
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    const auto is_old = [&] {
        return fs::last_write_time(owner) < fs::file_time_type::clock::now() - std::chrono::minutes(1);
    };
    while (is_old() && std::chrono::steady_clock::now() < deadline)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_FALSE(is_old());
}

TEST_F(FolderLeaseTest, AMasterWhoseFolderWasTakenRecordsNothingMore) {
    auto master = start(1);
    join_all(master->authority);
    for (std::uint64_t step = 0; step < 10; ++step) act(master->authority, step);
    const Hash128 hash = master->authority.scene().state_hash();
    const std::string before = read(journal_path(folder, 1));
    write(owner, Other);
    std::this_thread::sleep_for(FolderLease::Settings{}.recheck);
    const scene::Edit edit{
        .session = session(0),
        .sequence = master->authority.last_sequence(session(0)) + 1,
        .entries = {
            scene::Create{{master->authority.join(session(0), "user 0", 100).first}, scene::Material{}}}};
    const EditAnswer answer = master->authority.submit(edit);
    ASSERT_FALSE(answer.accepted);
    EXPECT_NE(answer.problems.at(0).find("the master on elsewhere (process 77) has taken over"),
              std::string::npos)
        << answer.problems.at(0);
    EXPECT_EQ(master->authority.scene().state_hash(), hash) << "the edit was reverted";
    EXPECT_EQ(read(journal_path(folder, 1)), before);
    EXPECT_THROW(master->journal->start_segment(), Error);
    CheckpointWriter writer(folder, master->stored, master->files->lease());
    writer.start({2, {"the room", {}}, master->authority.save(), {}});
    writer.wait();
    EXPECT_NE(writer.take_result()->problem.find("has taken over"), std::string::npos);
    EXPECT_TRUE(session_files(folder).checkpoints.empty());
    master.reset();
    EXPECT_EQ(read(owner), Other) << "it is not removed by another";
}

}  // namespace
}  // namespace tessera::master
