// Finished jobs outlive the master, and no file in their folder crashes it.
#include "master/job_store.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/base/random.h"

namespace tessera::master {
namespace {

namespace fs = std::filesystem;

wire::StoredJob job(const std::string& user, const std::string& name, std::int64_t ended_at = 1) {
    return {.status = {.job = {user, name},
                       .scene = "room",
                       .has_ended = true,
                       .progress = {},
                       .summary = {.outcome = session::Outcome::TimeUp, .message = "late", .samples = 77},
                       .ended_at = ended_at},
            .width = 4,
            .height = 2,
            .components = 3};
}

std::shared_ptr<const std::vector<std::byte>> picture(std::size_t bytes, int value = 3) {
    return std::make_shared<const std::vector<std::byte>>(bytes, std::byte(value));
}

struct JobStoreTest : testing::Test {
    fs::path folder = fs::temp_directory_path() / ("tessera-jobs-" + std::to_string(::getpid()));
    std::vector<std::string> reported;
    EventSink events = [this](const Event& event) { reported.push_back(event.text); };

    void SetUp() override { fs::remove_all(folder); }
    void TearDown() override { fs::remove_all(folder); }
    fs::path only_file() const { return fs::directory_iterator(folder)->path(); }
};

TEST_F(JobStoreTest, AreRestoredInTheOrderOfTheirEnds) {
    {
        JobStore jobs(events);
        jobs.record_to(folder);
        jobs.add(job("ann", "b", 10), picture(5, 7));
        jobs.add(job("ann", "a", 20), picture(0));
        jobs.add(job("bob", "c", 30), picture(1));
    }
    JobStore jobs(events);
    jobs.record_to(folder);
    ASSERT_EQ(jobs.all().size(), 3u);
    EXPECT_EQ(jobs.all()[0]->job.status.job, (session::JobName{"ann", "b"}));
    EXPECT_EQ(jobs.all()[2]->job.status.job, (session::JobName{"bob", "c"}));
    const JobStore::Entry* stored = jobs.find({"ann", "b"});
    ASSERT_NE(stored, nullptr);
    EXPECT_EQ(*stored->picture, *picture(5, 7));
    EXPECT_EQ(stored->job.status.summary.outcome, session::Outcome::TimeUp);
    EXPECT_EQ(stored->job.status.summary.samples, 77u);
    EXPECT_EQ(stored->job.width, 4u);
    EXPECT_TRUE(reported.empty());
}

TEST_F(JobStoreTest, RemovedJobsAreNotRestored) {
    {
        JobStore jobs(events);
        jobs.record_to(folder);
        jobs.add(job("ann", "a"), picture(5));
        EXPECT_TRUE(jobs.remove({"ann", "a"}));
        EXPECT_FALSE(jobs.remove({"ann", "a"}));
        EXPECT_EQ(jobs.find({"ann", "a"}), nullptr);
    }
    JobStore jobs(events);
    jobs.record_to(folder);
    EXPECT_TRUE(jobs.all().empty());
}

TEST_F(JobStoreTest, TheOldestAreRemovedWhenThereAreTooMany) {
    JobStore jobs(events);
    for (int i = 0; i < 300; ++i) jobs.add(job("ann", "job " + std::to_string(i)), picture(1));
    EXPECT_EQ(jobs.all().size(), 256u);
    EXPECT_EQ(jobs.find({"ann", "job 0"}), nullptr);
    EXPECT_NE(jobs.find({"ann", "job 299"}), nullptr);
    ASSERT_EQ(reported.size(), 44u);
    EXPECT_NE(reported[0].find("limit of stored jobs"), std::string::npos);
}

// The name of a job comes from the network.
TEST_F(JobStoreTest, NamesCannotEscapeTheJobFolder) {
    const std::vector<std::string> names{"../../outside", "/etc/passwd", "a/b", ".", std::string("a\0b", 3)};
    {
        JobStore jobs(events);
        jobs.record_to(folder);
        for (const std::string& name : names) jobs.add(job("../ann", name), picture(1));
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()),
              std::ptrdiff_t(names.size()));
    for (const auto& file : fs::directory_iterator(folder)) {
        EXPECT_TRUE(file.is_regular_file());
        EXPECT_EQ(file.path().filename().string().find_first_not_of("0123456789abcdef"), 64u);
    }
}

TEST_F(JobStoreTest, DamagedFilesAreReportedAndTheOthersUsed) {
    {
        JobStore jobs(events);
        jobs.record_to(folder);
        jobs.add(job("ann", "a"), picture(50));
    }
    const fs::path path = only_file();
    std::ifstream in(path, std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    CounterRandom random(1);
    for (int round = 0; round < 200; ++round) {
        std::string damaged = whole;
        if (round % 3 == 0) {
            damaged.resize(random.below(static_cast<std::uint32_t>(whole.size())));
        } else {
            damaged[random.below(static_cast<std::uint32_t>(whole.size()))] ^= char(1 + random.below(255));
        }
        std::ofstream(path, std::ios::binary) << damaged;
        reported.clear();
        JobStore jobs(events);
        jobs.record_to(folder);
        EXPECT_TRUE(jobs.all().empty());
        ASSERT_EQ(reported.size(), 1u);
        EXPECT_NE(reported[0].find(path.string()), std::string::npos) << reported[0];
    }
    EXPECT_TRUE(fs::exists(path)) << "damaged files are kept for inspection";
}

TEST_F(JobStoreTest, AnInvalidFolderIsAnError) {
    std::ofstream(folder) << "a file";
    JobStore jobs(events);
    EXPECT_THROW(jobs.record_to(folder / "jobs"), Error);
}

TEST_F(JobStoreTest, JobsOfLostClientsExpireAndOthersStay) {
    JobStore jobs(events);
    jobs.add(job("ann", "kept"), picture(5));
    wire::StoredJob lost = job("ann", "lost");
    lost.status.kept_until = 100;
    jobs.add(wire::StoredJob(lost), picture(5));
    EXPECT_EQ(jobs.unused_name({"ann", "lost"}), "lost (2)");
    EXPECT_EQ(jobs.unused_name({"bob", "lost"}), "lost");
    const TimePoint start{};
    jobs.remove_expired(60, start);
    jobs.remove_expired(std::int64_t{1} << 60, start + Duration(39));  // the wall clock was set
    EXPECT_EQ(jobs.all().size(), 2u);
    jobs.remove_expired(0, start + Duration(40));
    ASSERT_EQ(jobs.all().size(), 1u);
    EXPECT_EQ(jobs.all()[0]->job.status.job.name, "kept");
    EXPECT_EQ(reported.size(), 1u);
}

// Before a restart the wall clock was set back by a year: the job is kept as long as it was to be, from now on.
TEST_F(JobStoreTest, ARestoredJobIsNotKeptLongerThanPromised) {
    JobStore jobs(events);
    wire::StoredJob lost = job("ann", "lost", 1'000'000);
    lost.status.kept_until = 1'000'100;
    jobs.add(std::move(lost), picture(5));
    const TimePoint start{};
    jobs.remove_expired(0, start);
    jobs.remove_expired(0, start + Duration(99));
    EXPECT_EQ(jobs.all().size(), 1u);
    jobs.remove_expired(0, start + Duration(100));
    EXPECT_TRUE(jobs.all().empty());
}

}  // namespace
}  // namespace tessera::master
