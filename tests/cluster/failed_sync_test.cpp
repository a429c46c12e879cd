// A disk that fails for a while: edits are refused meanwhile, and accepted again.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "master/scene/session_folder.h"
#include "mediator/scene/blob_file.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using namespace scene;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

struct FailedSync : testing::Test {
    const fs::path folder = fs::temp_directory_path() / ("tessera-failed-sync-" + std::to_string(::getpid()));
    std::optional<LoopbackCluster> cluster;
    std::shared_ptr<BlobStore> blobs = std::make_shared<BlobStore>();
    std::unique_ptr<client::Session> ann;
    std::vector<ObjectId> accepted;
    ObjectId refused;

    FailedSync() { fs::remove_all(folder); }
    ~FailedSync() override {
        ann.reset();
        cluster.reset();
        fs::remove_all(folder);
    }
    void start() {
        ann.reset();
        cluster.reset();
        cluster.emplace([&](master::MasterSettings& settings) {
            settings.session_folder = folder;
            settings.checkpoint_interval = std::chrono::hours(1);
        });
        ann = cluster->member("ann", blobs);
    }
    // The reason, "" if it was accepted.
    std::string submit(Object object) {
        const ObjectId id = ann->new_id();
        const auto done = ann->submit({Create{id, std::move(object)}});
        if (done.accepted) {
            accepted.push_back(id);
            return {};
        }
        refused = id;
        return done.problems.at(0);
    }
    // The reason of the first edit that is refused within a minute, or "" of the first that is accepted.
    std::string submit_until(bool is_accepted) {
        std::string reason;
        const auto deadline = std::chrono::steady_clock::now() + 1min;
        do {
            reason = submit(Transform{.name = "group"});
            std::this_thread::sleep_for(10ms);
        } while (reason.empty() != is_accepted && std::chrono::steady_clock::now() < deadline);
        return reason;
    }
};

// Stand-ins: a named pipe, which cannot be synced, for a blob's file; folders where checkpoints are to be written.
TEST_F(FailedSync, EditsAreAcceptedAgainWhenACheckpointWasWritten) {
    start();
    ASSERT_EQ(submit(Material{}), "");
    const auto has_checkpoint = [&] { return ann->status().scene.checkpoints > 0; };
    for (int i = 0; i < 100 && !has_checkpoint(); ++i) std::this_thread::sleep_for(10ms);
    std::vector<fs::path> obstacles;
    const std::uint64_t newest = master::session_files(folder).journals.back();
    for (std::uint64_t number = newest + 1; number < newest + 60; ++number) {
        obstacles.emplace_back(master::checkpoint_path(folder, number).string() + ".part");
        fs::create_directory(obstacles.back());
    }
    const BlobPtr blob = blobs->insert(std::vector<std::byte>(4096, std::byte{7}));
    const fs::path pipe =
        blob_path(folder / "blobs", reference(*blob)).string() + "." + std::to_string(::getpid()) + ".part";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const int reader = ::open(pipe.c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_EQ(submit(Texture{.name = "wood", .width = 32, .height = 32, .texels = reference(*blob)}), "");

    const std::string reason = submit_until(false);
    EXPECT_NE(reason.find("the journal cannot be written to disk: "), std::string::npos) << reason;
    EXPECT_NE(reason.find("edits are accepted again when a checkpoint can be written"), std::string::npos)
        << reason;
    const ObjectId lost = refused;
    std::this_thread::sleep_for(1500ms);
    EXPECT_NE(submit(Transform{}), "") << "no checkpoint could be written";
    for (const fs::path& obstacle : obstacles) fs::remove(obstacle);
    EXPECT_EQ(submit_until(true), "");
    ASSERT_EQ(submit(Light{.name = "lamp"}), "");
    const std::vector<std::string> events = cluster->events();
    EXPECT_NE(std::ranges::find(events, "the session is on disk again: edits are accepted"), events.end());
    ::close(reader);

    start();
    ann->refresh();
    for (const ObjectId id : accepted) EXPECT_NE(ann->scene().find(id), nullptr);
    EXPECT_EQ(ann->scene().find(lost), nullptr);
    EXPECT_NE(read_blob(folder / "blobs", reference(*blob)), nullptr) << "it was not written again";
}

}  // namespace
}  // namespace tessera::test
