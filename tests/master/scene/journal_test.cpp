#include "master/scene/journal.h"

#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <set>

#include "tests/master/scene/session_fixture.h"

namespace tessera::master {
namespace {

using namespace scene;

std::vector<std::byte> payload(std::uint64_t seed) {
    CounterRandom random(seed);
    std::vector<std::byte> bytes(1 + random.below(60));
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.bits());
    return bytes;
}

struct JournalFileTest : SessionFixture {
    static constexpr std::uint64_t Records = 12;
    fs::path file = folder / "journal-000007";

    void SetUp() override {
        fs::create_directories(folder);
        JournalFile journal(file, 7);
        for (std::uint64_t i = 0; i < Records; ++i) ASSERT_TRUE(journal.append(payload(i)));
        ASSERT_EQ(journal.byte_size(), fs::file_size(file));
    }
    // What is read is the first records as they were written, whatever happened to the file.
    JournalScan scan_prefix() const {
        std::uint64_t next = 0;
        const JournalScan scan = read_journal(file, 7, [&](std::span<const std::byte> bytes) {
            const auto expected = payload(next++);
            EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), expected.begin(), expected.end()));
            return Expected<void>();
        });
        EXPECT_EQ(scan.records, next);
        return scan;
    }
};

TEST_F(JournalFileTest, ReadsWhatWasAppended) {
    const JournalScan scan = scan_prefix();
    EXPECT_EQ(scan.records, Records);
    EXPECT_EQ(scan.end, JournalEnd::Complete);
    EXPECT_THROW(JournalFile(file, 7), Error) << "never over one that is there";
    EXPECT_EQ(read_journal(file, 8, [](auto) { return Expected<void>(); }).end, JournalEnd::Damaged);
}

TEST_F(JournalFileTest, TruncatedFileKeepsTheCompleteRecords) {
    const std::string whole = read(file);
    std::uint64_t last = Records;
    for (std::size_t size = whole.size(); size-- > 0;) {
        write(file, whole.substr(0, size));
        const JournalScan scan = scan_prefix();
        ASSERT_LE(scan.records, last);
        ASSERT_LE(scan.offset, size);
        ASSERT_EQ(scan.end == JournalEnd::Complete, scan.offset == size && size != 0);
        ASSERT_NE(scan.end, JournalEnd::Damaged);
        last = scan.records;
    }
    EXPECT_EQ(last, 0u);
}

TEST_F(JournalFileTest, DetectsFlippedBitsAndRepairsThoseOfLengths) {
    const std::string whole = read(file);
    std::set<std::size_t> bytes_of_lengths;
    for (std::size_t at = 16; at < whole.size();) {
        std::uint32_t length = 0;
        std::memcpy(&length, whole.data() + at, sizeof length);
        for (std::size_t i = 0; i < sizeof length; ++i) bytes_of_lengths.insert(at + i);
        at += sizeof length + 16 + length;
    }
    for (std::size_t bit = 0; bit < whole.size() * 8; bit += 7) {
        std::string damaged = whole;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
        write(file, damaged);
        const JournalScan scan = scan_prefix();
        if (bytes_of_lengths.contains(bit / 8)) {
            ASSERT_EQ(scan.end, JournalEnd::Complete);
            ASSERT_EQ(scan.records, Records);
            ASSERT_EQ(scan.repaired, 1u);
            continue;
        }
        ASSERT_EQ(scan.repaired, 0u);
        ASSERT_LT(scan.records, Records);
        ASSERT_NE(scan.end, JournalEnd::Complete);
        ASSERT_LE(scan.offset, bit / 8);
        ASSERT_NE(scan.text.find("at byte " + std::to_string(scan.offset)), std::string::npos);
    }
}

TEST_F(JournalFileTest, DetectsReorderedRecords) {
    const std::string whole = read(file);
    const JournalScan first = read_journal(file, 7, [n = 0](auto) mutable {
        return n++ == 0 ? Expected<void>() : failure(ErrorCode::InvalidInput, "enough");
    });
    write(file, whole.substr(0, 16) + whole.substr(first.offset));
    EXPECT_EQ(scan_prefix().records, 0u) << "the first is left out";
}

// Sets how long files may become: writes beyond fail as on a full disk, in the middle of a record.
struct FileLimit {
    explicit FileLimit(std::uint64_t bytes) {
        std::signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &before);
        rlimit limit = before;
        limit.rlim_cur = bytes;
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileLimit() {
        setrlimit(RLIMIT_FSIZE, &before);
        std::signal(SIGXFSZ, SIG_DFL);
    }
    rlimit before{};
};

TEST_F(JournalFileTest, FailedWriteLeavesNoPartialRecord) {
    const fs::path other = folder / "journal-000009";
    JournalFile journal(other, 9);
    ASSERT_TRUE(journal.append(payload(0)));
    const std::uint64_t size = journal.byte_size();
    {
        const FileLimit full(size + 25);
        const auto answer = journal.append(std::vector<std::byte>(1000));
        ASSERT_FALSE(answer);
        EXPECT_EQ(answer.error().code(), ErrorCode::Io);
        EXPECT_EQ(fs::file_size(other), size);
    }
    ASSERT_TRUE(journal.append(payload(1)));
    EXPECT_EQ(read_journal(other, 9, [](auto) { return Expected<void>(); }).records, 2u);
}

struct JournalTest : SessionFixture {};

TEST_F(JournalTest, ARestartedMasterHasTheSceneTheHistoryAndTheEditors) {
    auto master = start(1);
    EXPECT_FALSE(master->recovery.found);
    join_all(master->authority);
    ASSERT_TRUE(master->journal->opened({"the room", {}}));
    int accepted = 0;
    for (std::uint64_t step = 1; step <= 400; ++step) accepted += act(master->authority, step).accepted;
    ASSERT_GT(accepted, 200);
    std::vector<std::uint64_t> sequences;
    for (std::uint64_t m = 0; m < Members; ++m)
        sequences.push_back(master->authority.last_sequence(session(m)));
    Master old(0);
    std::swap(old.authority, master->authority);
    old.authority.record_to(nullptr);
    master.reset();

    auto again = start(2);
    EXPECT_TRUE(again->recovery.found);
    EXPECT_EQ(again->recovery.scene.title, "the room");
    EXPECT_EQ(again->authority.version(), (Version{2, 1}));
    EXPECT_FALSE(again->authority.has_unpublished());
    expect_same(old.authority, again->authority);
    join_all(again->authority);
    for (std::uint64_t m = 0; m < Members; ++m) {
        // Rejected edits are not recorded: an editor that joins again continues with a later number.
        EXPECT_LE(again->authority.last_sequence(session(m)), sequences[m]);
        EXPECT_EQ(again->authority.join(session(m), "user " + std::to_string(m), 100 + m).first,
                  old.authority.join(session(m), "user " + std::to_string(m), 100 + m).first);
    }
    // What is done from here on comes out the same: undo reaches back behind the restart.
    for (std::uint64_t number = again->authority.transactions(); number > 250; --number) {
        EditAnswer answers[2];
        for (int i = 0; i < 2; ++i) {
            SceneAuthority& authority = i == 0 ? old.authority : again->authority;
            const Edit edit{
                .session = session(0), .sequence = authority.last_sequence(session(0)) + 1, .undo = number};
            answers[i] = authority.submit(edit, {"member", "user", 1});
        }
        ASSERT_EQ(answers[0].accepted, answers[1].accepted);
        ASSERT_EQ(answers[0].problems, answers[1].problems);
        ASSERT_EQ(answers[0].notes, answers[1].notes);
    }
    expect_same(old.authority, again->authority);
}

TEST_F(JournalTest, AnEditResentAfterTheRestartGetsItsAnswerAgain) {
    auto master = start(1);
    join_all(master->authority);
    const ObjectId lamp{master->authority.join(session(0), "user 0", 100).first};
    const Edit edit{.session = session(0), .sequence = 1, .entries = {Create{lamp, Light{}}}};
    const auto first = master->authority.submit(edit);
    ASSERT_TRUE(first.accepted);
    master.reset();
    auto again = start(2);
    join_all(again->authority);
    const auto answer = again->authority.submit(edit);
    EXPECT_TRUE(answer.accepted);
    EXPECT_EQ(answer.transaction, first.transaction);
    EXPECT_EQ(answer.version, again->authority.version()) << "one that is known";
    EXPECT_EQ(again->authority.history(10).size(), 1u) << "not done twice";
}

TEST_F(JournalTest, TornEndIsTruncatedReportedAndContinued) {
    Hash128 before{};
    for (std::uint64_t round = 1; round <= 5; ++round) {
        auto master = start(round);
        if (round > 1) {
            EXPECT_TRUE(mentions(master->recovery, "is cut off"));
            EXPECT_EQ(master->authority.scene().state_hash(), before);
        }
        join_all(master->authority);
        for (std::uint64_t step = 1; step <= 20; ++step) act(master->authority, round * 1000 + step);
        before = master->authority.scene().state_hash();
        master.reset();
        std::ofstream(journal_path(folder, round), std::ios::binary | std::ios::app) << "half a rec";
    }
    EXPECT_EQ(session_files(folder).journals.size(), 5u);
}

TEST_F(JournalTest, DamagedRecordEndsReplayAndUnusableDataIsKept) {
    auto master = start(1);
    join_all(master->authority);
    for (std::uint64_t step = 1; step <= 50; ++step) act(master->authority, step);
    master->journal->start_segment();
    for (std::uint64_t step = 51; step <= 60; ++step) act(master->authority, step);
    master.reset();
    std::string content = read(journal_path(folder, 1));
    content[content.size() / 2] = static_cast<char>(content[content.size() / 2] ^ 4);
    write(journal_path(folder, 1), content);
    auto again = start(2);
    EXPECT_TRUE(mentions(again->recovery, "everything from there on is lost"));
    EXPECT_TRUE(mentions(again->recovery, "journal-000001' at byte "));
    EXPECT_TRUE(fs::exists(journal_path(folder, 2).string() + ".damaged"));
    EXPECT_GT(again->recovery.edits, 5u);
    EXPECT_LT(again->recovery.edits, 50u);
    EXPECT_EQ(again->recovery.next_segment, 2u);
    const Hash128 state = again->authority.scene().state_hash();
    again.reset();
    auto third = start(3);
    EXPECT_EQ(third->authority.scene().state_hash(), state) << "and from then on it is whole again";
    EXPECT_FALSE(mentions(third->recovery, "lost"));
}

TEST_F(JournalTest, BlobsAreStoredAndRecovered) {
    const Blob indices(std::as_bytes(std::span<const char>("012345678901", 12)));
    Geometry triangle{.indices = reference(indices)};
    triangle.positions = {indices.hash(), 12};
    ObjectId id;
    {
        auto master = start(1);
        join_all(master->authority);
        id = {master->authority.join(session(0), "user 0", 100).first};
        const Edit edit{.session = session(0), .sequence = 1, .entries = {Create{id, triangle}}};
        EXPECT_FALSE(master->authority.submit(edit).accepted) << "its bytes are not here";
        master->blobs->insert(indices.bytes());
        Edit next = edit;
        next.sequence = 2;
        ASSERT_TRUE(master->authority.submit(next).accepted);
        next = {.session = session(0), .sequence = 3, .entries = {Remove{id}}};
        ASSERT_TRUE(master->authority.submit(next).accepted);
    }
    auto again = start(2);
    ASSERT_TRUE(again->blobs->find(indices.hash())) << "an undo may need it";
    EXPECT_EQ(again->recovery.notes.size(), 1u);
    again.reset();
    write(folder / "blobs" / to_hex(indices.hash()), "012345678901x");
    EXPECT_TRUE(mentions(start(3)->recovery, "missing or damaged"));
}

TEST_F(JournalTest, FullDiskRejectsOnlyTheEdit) {
    auto master = start(1);
    join_all(master->authority);
    const ObjectId first{master->authority.join(session(0), "user 0", 100).first};
    const Hash128 before = master->authority.scene().state_hash();
    Light lamp{.name = std::string(2000, 'x')};
    {
        const FileLimit full(fs::file_size(journal_path(folder, 1)) + 100);
        const auto answer = master->authority.submit(
            {.session = session(0), .sequence = 1, .entries = {Create{first, lamp}}});
        EXPECT_FALSE(answer.accepted);
        ASSERT_EQ(answer.problems.size(), 1u);
        EXPECT_NE(answer.problems[0].find("cannot write"), std::string::npos);
    }
    EXPECT_EQ(master->authority.scene().state_hash(), before);
    ASSERT_TRUE(
        master->authority.submit({.session = session(0), .sequence = 2, .entries = {Create{first, lamp}}})
            .accepted);
    const Hash128 after = master->authority.scene().state_hash();
    master.reset();
    EXPECT_EQ(start(2)->authority.scene().state_hash(), after);
}

TEST_F(JournalTest, JobsAreJournaled) {
    auto master = start(1);
    join_all(master->authority);
    ASSERT_TRUE(master->journal->opened({"room", wire::RecordedOwner{"ann", 7}}));
    const auto job = [](const std::string& user, const std::string& name, std::uint64_t spp) {
        wire::SavedView view{.name = name, .owner_user = user, .owner_key = 7};
        view.request.name = name;
        view.request.stop.spp = spp;
        view.request.detached = true;
        return view;
    };
    ASSERT_TRUE(master->journal->job_started(job("ann", "night", 5)));
    ASSERT_TRUE(master->journal->job_started(job("bob", "night", 6)));
    ASSERT_TRUE(master->journal->job_started(job("ann", "day", 7)));
    ASSERT_TRUE(master->journal->job_started(job("ann", "night", 8)));  // said again
    ASSERT_TRUE(master->journal->job_ended({"ann", "day"}));
    master.reset();
    auto again = start(2);
    ASSERT_TRUE(again->recovery.scene.owner);
    EXPECT_EQ(again->recovery.scene.owner->user, "ann");
    EXPECT_EQ(again->recovery.scene.owner->key, 7u);
    ASSERT_EQ(again->recovery.views.size(), 2u);
    EXPECT_EQ(again->recovery.views[0].owner_user, "bob");
    EXPECT_EQ(again->recovery.views[1].request.stop.spp, 8u);
    EXPECT_TRUE(again->recovery.views[1].request.detached);
}

TEST_F(JournalTest, ClosedSceneStaysClosedAndRenderOriginIsKept) {
    auto master = start(1);
    join_all(master->authority);
    for (std::uint64_t step = 1; step <= 20; ++step) act(master->authority, step);
    master->authority.clear();
    join_all(master->authority);
    ASSERT_TRUE(master->journal->opened({"another", {}}));
    ASSERT_TRUE(master->authority.follow_camera({1e6, 0, 0}));
    for (std::uint64_t step = 21; step <= 30; ++step) act(master->authority, step);
    const Hash128 state = master->authority.scene().state_hash();
    master.reset();
    auto again = start(2);
    EXPECT_EQ(again->recovery.scene.title, "another");
    EXPECT_EQ(again->authority.scene().state_hash(), state);
    EXPECT_EQ(again->recovery.notes.size(), 1u) << again->recovery.notes.at(0);
}

TEST_F(JournalTest, AFolderHasOneMaster) {
    auto master = start(1);
    EXPECT_THROW(SessionFolder{folder}, Error);
    master.reset();
    EXPECT_NO_THROW(SessionFolder{folder});
}

}  // namespace
}  // namespace tessera::master
