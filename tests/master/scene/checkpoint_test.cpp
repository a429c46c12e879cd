#include "master/scene/checkpoint_file.h"
#include "master/scene/checkpoint_writer.h"
#include "tests/master/scene/session_fixture.h"

namespace tessera::master {
namespace {

struct CheckpointTest : SessionFixture {
    static wire::SavedView film(std::uint64_t seed) {
        wire::SavedView view{.name = "main", .owner_user = "user 0", .owner_key = 100, .number = seed};
        view.request.view.width = 64;
        view.request.view.height = 32;
        view.request.stop.spp = 16;
        view.scene_hash_of_film = {seed, 5};
        CounterRandom random(seed);
        for (std::int32_t x = 0; x < 64; x += 32) {
            frame::FilmTile tile({x, 0, 32, 32}, {0, 2}, {frame::Channel::Radiance, frame::Channel::Depth});
            for (float& value : tile.planes) value = static_cast<float>(random.uniform());
            for (std::uint32_t& count : tile.counts) count = static_cast<std::uint32_t>(random.below(5));
            view.blocks.push_back(std::move(tile));
        }
        return view;
    }

    // As the live service does it.
    static CheckpointResult checkpoint(Master& master, const fs::path& folder, std::uint64_t seed) {
        CheckpointWriter writer(folder);
        const std::uint64_t number = master.journal->start_segment();
        writer.start({number, {"the room", {}}, master.authority.save(), {film(seed)}});
        writer.wait();
        const auto result = writer.take_result();
        EXPECT_TRUE(result);
        EXPECT_FALSE(writer.take_result()) << "reported once";
        EXPECT_EQ(result->problem, "");
        EXPECT_EQ(result->byte_size, fs::file_size(checkpoint_path(folder, number)));
        return *result;
    }

    // A session of 3 x 60 steps, each 60 but the last before a checkpoint; what the authority was in the end.
    std::unique_ptr<Master> three_parts() {
        auto master = start(1);
        join_all(master->authority);
        for (std::uint64_t part = 0; part < 3; ++part) {
            if (part != 0) checkpoint(*master, folder, part);
            for (std::uint64_t step = 1; step <= 60; ++step) act(master->authority, part * 60 + step);
        }
        master->authority.record_to(nullptr);
        master->journal.reset();
        master->files.reset();
        return master;
    }
};

TEST_F(CheckpointTest, RecoversFromTheNewestAndTheJournalAfterIt) {
    const auto before = three_parts();
    const auto again = start(2);
    EXPECT_TRUE(mentions(again->recovery, "checkpoint-000003' was used"));
    EXPECT_LE(again->recovery.edits, 60u);
    EXPECT_EQ(again->recovery.scene.title, "the room");
    expect_same(before->authority, again->authority);
    ASSERT_EQ(again->recovery.views.size(), 1u);
    const wire::SavedView &saved = again->recovery.views[0], original = film(2);
    EXPECT_EQ(saved.name, "main");
    EXPECT_EQ(saved.owner_user, "user 0");
    EXPECT_EQ(saved.owner_key, 100u);
    EXPECT_EQ(saved.number, 2u);
    EXPECT_EQ(saved.request.stop.spp, 16u);
    EXPECT_EQ(saved.request.view.width, 64u);
    EXPECT_EQ(saved.scene_hash_of_film, original.scene_hash_of_film);
    ASSERT_EQ(saved.blocks.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_TRUE(identical_bits(saved.blocks[i], original.blocks[i]));
}

TEST_F(CheckpointTest, FilmOfAnotherRenderRevisionIsDroppedAndItsViewKept) {
    const auto before = three_parts();
    const fs::path newest = checkpoint_path(folder, 3);
    auto state = read_checkpoint(newest, 3);
    ASSERT_TRUE(state);
    EXPECT_EQ(state->render_revision, frame::RenderRevision);
    state->render_revision = frame::RenderRevision + 1;
    write_checkpoint(newest, 3, *state);
    const auto again = start(2);
    EXPECT_TRUE(mentions(again->recovery, "its views start again"));
    expect_same(before->authority, again->authority);
    ASSERT_EQ(again->recovery.views.size(), 1u);
    EXPECT_EQ(again->recovery.views[0].request.view.width, 64u);
    EXPECT_TRUE(again->recovery.views[0].blocks.empty());
}

TEST_F(CheckpointTest, LaterEditsGiveTheSameResult) {
    const auto before = three_parts();
    const auto again = start(2);
    again->authority.record_to(nullptr);
    for (int i = 0; i < 2; ++i) join_all(i == 0 ? before->authority : again->authority);
    for (std::uint64_t number = again->authority.transactions(); number > 40; --number) {
        for (SceneAuthority* authority : {&before->authority, &again->authority}) {
            authority->submit(
                {.session = session(1), .sequence = authority->last_sequence(session(1)) + 1, .undo = number},
                {"member", "user", 1});
        }
    }
    expect_same(before->authority, again->authority);
}

TEST_F(CheckpointTest, TornCheckpointIsReportedAndThePreviousOneUsed) {
    const auto before = three_parts();
    const fs::path newest = checkpoint_path(folder, 3);
    const std::string content = read(newest);
    write(newest, content.substr(0, content.size() - 7));
    {
        const auto again = start(2);
        EXPECT_TRUE(mentions(again->recovery, "checkpoint-000003': its checksum is wrong"));
        EXPECT_TRUE(mentions(again->recovery, "checkpoint-000002' was used"));
        EXPECT_TRUE(fs::exists(newest.string() + ".damaged"));
        expect_same(before->authority, again->authority);
        EXPECT_EQ(again->recovery.views.at(0).number, 1u) << "the film as it was then";
    }
}

TEST_F(CheckpointTest, WithoutAValidCheckpointTheWholeJournalIsReplayed) {
    auto master = start(1);
    join_all(master->authority);
    for (std::uint64_t step = 1; step <= 60; ++step) {
        act(master->authority, step);
        if (step == 30) checkpoint(*master, folder, 1);
    }
    Master before(0);
    std::swap(before.authority, master->authority);
    before.authority.record_to(nullptr);
    master.reset();
    write(checkpoint_path(folder, 2), "no checkpoint");
    const auto again = start(2);
    EXPECT_TRUE(mentions(again->recovery, "checkpoint-000002': it ends too early"));
    EXPECT_TRUE(again->recovery.views.empty());
    expect_same(before.authority, again->authority);
}

TEST_F(CheckpointTest, UnusableFilesAreKept) {
    auto master = three_parts();
    master.reset();
    fs::remove(journal_path(folder, 1));
    for (const std::uint64_t number : {2, 3}) write(checkpoint_path(folder, number), "no");
    EXPECT_THROW(start(2), Error);
    EXPECT_TRUE(fs::exists(checkpoint_path(folder, 3)));
    EXPECT_TRUE(fs::exists(journal_path(folder, 2)));
}

TEST_F(CheckpointTest, KeepsTwoAndTheJournalFromTheOlderOneOn) {
    auto master = start(1);
    join_all(master->authority);
    for (std::uint64_t i = 1; i <= 5; ++i) {
        act(master->authority, i);
        checkpoint(*master, folder, i);
    }
    const SessionFiles files = session_files(folder);
    EXPECT_EQ(files.checkpoints, (std::vector<std::uint64_t>{5, 6}));
    EXPECT_EQ(files.journals, (std::vector<std::uint64_t>{5, 6}));
}

TEST_F(CheckpointTest, MalformedFilesAreRefusedAndNeverCrash) {
    three_parts();
    const fs::path path = checkpoint_path(folder, 3);
    const std::string whole = read(path);
    ASSERT_TRUE(read_checkpoint(path, 3));
    EXPECT_FALSE(read_checkpoint(path, 4)) << "another number";
    EXPECT_FALSE(read_checkpoint(folder / "checkpoint-000099", 99)) << "not there";
    CounterRandom random(1);
    for (int i = 0; i < 300; ++i) {
        std::string damaged = whole;
        const std::size_t place = random.below(whole.size());
        if (i % 3 == 0) {
            damaged.resize(place);
        } else {
            damaged[place] = static_cast<char>(damaged[place] ^ (1 << random.below(8)));
        }
        write(path, damaged);
        ASSERT_FALSE(read_checkpoint(path, 3));
    }
    // A liar who knows the checksum: any content, any length.
    int refused = 0;
    for (int i = 0; i < 600; ++i) {
        std::string damaged = whole.substr(0, whole.size() - 32);
        for (std::uint64_t changes = 1 + random.below(3); changes > 0; --changes) {
            const std::size_t reach = i % 2 == 0 ? 200 : damaged.size();
            damaged[8 + random.below(reach - 8)] = static_cast<char>(random.bits());
        }
        if (i % 5 == 0) damaged.resize(20 + random.below(damaged.size() - 20));
        const Hash256 hash = blake2b(std::as_bytes(std::span(damaged)));
        damaged.append(reinterpret_cast<const char*>(hash.bytes.data()), 32);
        write(path, damaged);
        auto state = read_checkpoint(path, 3);
        if (state) {
            auto authority_state = restored(std::move(*state));
            if (authority_state) {
                SceneAuthority authority(9, std::make_shared<scene::BlobStore>());
                authority.restore(std::move(*authority_state));
                join_all(authority);
                for (std::uint64_t number = 1; number <= authority.transactions() && number < 300; ++number) {
                    authority.submit({.session = session(0),
                                      .sequence = authority.last_sequence(session(0)) + 1,
                                      .undo = number});
                }
                continue;
            }
        }
        ++refused;
    }
    EXPECT_GT(refused, 100);
}

// They are read part by part, however large they are.
TEST_F(CheckpointTest, HugeFilesTakeNoMemory) {
    fs::create_directories(folder);
    const fs::path checkpoint = checkpoint_path(folder, 1), journal = journal_path(folder, 1);
    for (const fs::path& path : {checkpoint, journal}) {
        write(path, "something else entirely");
        fs::resize_file(path, std::uintmax_t{1} << 40);
    }
    const auto state = read_checkpoint(checkpoint, 1);
    ASSERT_FALSE(state);
    EXPECT_NE(std::string(state.error().what()).find("it is no checkpoint"), std::string::npos);
    const JournalScan scan =
        read_journal(journal, 1, [](std::span<const std::byte>) { return Expected<void>(); });
    EXPECT_EQ(scan.end, JournalEnd::Damaged);
    EXPECT_EQ(scan.byte_size, std::uint64_t{1} << 40);
}

// Takes 5 GiB of memory, so it has the label `long`.
TEST_F(CheckpointTest, DISABLED_OneOfMoreThan2GiBIsReportedAndLosesNothing) {
    auto master = start(1);
    join_all(master->authority);
    for (std::uint64_t step = 1; step <= 60; ++step) act(master->authority, step);
    checkpoint(*master, folder, 1);
    for (std::uint64_t step = 61; step <= 90; ++step) act(master->authority, step);
    const std::uint64_t number = master->journal->start_segment();
    {
        CheckpointWriter writer(folder);
        writer.start(
            {number, {std::string((std::size_t{2} << 30) + 1000, 'x'), {}}, master->authority.save(), {}});
        writer.wait();
        const auto result = writer.take_result();
        ASSERT_TRUE(result);
        EXPECT_NE(result->problem.find("more than 2 GiB"), std::string::npos) << result->problem;
    }
    EXPECT_FALSE(fs::exists(checkpoint_path(folder, number)));
    for (std::uint64_t step = 91; step <= 120; ++step) act(master->authority, step);
    master->authority.record_to(nullptr);
    master->journal.reset();
    master->files.reset();
    const auto again = start(2);
    expect_same(master->authority, again->authority);
}

TEST_F(CheckpointTest, MissingFolderIsReported) {
    auto master = start(1);
    CheckpointWriter writer(folder / "nowhere");
    writer.start({2, {}, master->authority.save(), {}});
    writer.wait();
    EXPECT_NE(writer.take_result()->problem.find("cannot write"), std::string::npos);
    EXPECT_FALSE(writer.busy());
}

}  // namespace
}  // namespace tessera::master
