// Masters with a session folder whose content is not what they would write.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "master/scene/journal.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

struct SessionFolders : testing::Test {
    fs::path folder = fs::temp_directory_path() / ("tessera-session-folders-" + std::to_string(::getpid()));
    SessionFolders() { fs::remove_all(folder); }
    ~SessionFolders() override { fs::remove_all(folder); }

    std::unique_ptr<LoopbackCluster> start() const {
        return std::make_unique<LoopbackCluster>(
            [this](master::MasterSettings& settings) { settings.session_folder = folder; });
    }
    static bool has_event(const LoopbackCluster& cluster, const std::string& part) {
        const auto events = cluster.events();
        return std::ranges::any_of(
            events, [&](const std::string& text) { return text.find(part) != std::string::npos; });
    }
};

wire::SavedView job(const std::string& name, const session::StopRule& stop) {
    wire::SavedView view{.name = name, .owner_user = "ann", .owner_key = 7};
    view.request = {.name = name,
                    .stop = stop,
                    .frames = session::Frames::Last,
                    .picture = session::PictureEncoding::Png,
                    .detached = true};
    view.request.view.width = view.request.view.height = 16;
    view.request.view.window = {0, 0, 16, 16};
    view.request.view.channels = {frame::Channel::Radiance};
    view.request.view.filter = "none";
    return view;
}

// An older version may have accepted them.
TEST_F(SessionFolders, RecordedJobsThatAreNotValidAreNamedAndLeftOut) {
    {
        master::SessionFolder made(folder);
        master::Journal journal(folder, std::make_shared<scene::BlobStore>(), 1);
        ASSERT_TRUE(journal.opened({"room", wire::RecordedOwner{"ann", 7}}));
        ASSERT_TRUE(journal.job_started(job("endless", {.spp = 4, .time_limit = Duration::max()})));
        ASSERT_TRUE(journal.job_started(job("negative", {.spp = 4, .budget = Duration::min()})));
        ASSERT_TRUE(journal.job_started(job("fine", {.spp = 4})));
    }
    const auto cluster = start();
    cluster->add_node("null");
    EXPECT_TRUE(has_event(*cluster, "'endless' of ann is not continued: the time limit or budget"));
    EXPECT_TRUE(has_event(*cluster, "'negative' of ann is not continued: the time budget"));
    const auto ann = cluster->session(std::make_shared<scene::BlobStore>(), net::Role::Editor, "ann");
    const auto deadline = std::chrono::steady_clock::now() + 30s;
    std::vector<session::JobStatus> jobs;
    do {
        jobs = ann->jobs();
    } while (!(jobs.size() == 1 && jobs[0].has_ended) && std::chrono::steady_clock::now() < deadline);
    ASSERT_EQ(jobs.size(), 1u);
    EXPECT_EQ(jobs[0].job.name, "fine");
    EXPECT_EQ(jobs[0].summary.outcome, session::Outcome::Complete);
}

}  // namespace
}  // namespace tessera::test
