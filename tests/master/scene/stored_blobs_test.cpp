// Blobs in the session folder: removed when nothing on disk refers to them, never before.
#include <set>

#include "master/scene/checkpoint_writer.h"
#include "mediator/scene/blob_file.h"
#include "tests/master/scene/session_fixture.h"

namespace tessera::master {
namespace {

struct StoredBlobsTest : SessionFixture {
    // Twelve bytes: a triangle's indices, and its positions.
    static scene::Blob blob(std::uint32_t number) {
        const std::array<std::uint32_t, 3> content{number, number, number};
        return scene::Blob(std::as_bytes(std::span(content)));
    }
    static scene::Geometry triangle(std::uint32_t number) {
        const scene::Blob content = blob(number);
        return {.indices = scene::reference(content), .positions = scene::reference(content)};
    }
    std::uint64_t sequence = 0;
    ObjectId id;

    std::unique_ptr<Master> run(std::uint64_t epoch) {
        auto master = start(epoch);
        join_all(master->authority);
        return master;
    }
    void submit(Master& master, std::vector<scene::Entry> entries) {
        const auto answer = master.authority.submit(
            {.session = session(0), .sequence = ++sequence, .entries = std::move(entries)});
        ASSERT_TRUE(answer.accepted) << answer.problems.at(0);
    }
    void create(Master& master, std::uint32_t number) {
        if (id.value == 0) id = {master.authority.join(session(0), "user 0", 100).first};
        master.blobs->insert(blob(number).bytes());
        submit(master, {scene::Create{id, triangle(number)}});
    }
    void replace(Master& master, std::uint32_t number) {
        master.blobs->insert(blob(number).bytes());
        submit(master, {scene::Remove{id}});
        id.value += 1;
        create(master, number);
    }
    // So many that no undo step remembers what was before.
    void fill_history(Master& master) {
        ++id.value;
        for (int i = 0; i < 300; ++i) {
            submit(master, {scene::Create{id, scene::Material{}}});
            submit(master, {scene::Remove{id}});
        }
        --id.value;
    }
    CheckpointResult checkpoint(Master& master) {
        CheckpointWriter writer(folder, master.stored);
        writer.start({master.journal->start_segment(), {"the room", {}}, master.authority.save(), {}});
        writer.wait();
        return writer.take_result().value();
    }
    bool is_stored(std::uint32_t number) const {
        return scene::read_blob(blobs_path(folder), scene::reference(blob(number))) != nullptr;
    }
};

TEST_F(StoredBlobsTest, AreRemovedWhenNeitherCheckpointNorJournalRefersToThem) {
    auto master = run(1);
    create(*master, 1);
    replace(*master, 2);
    ASSERT_EQ(checkpoint(*master).problem, "");
    ASSERT_EQ(checkpoint(*master).problem, "");
    EXPECT_TRUE(is_stored(1)) << "an undo step refers to it";
    fill_history(*master);
    ASSERT_EQ(checkpoint(*master).problem, "");
    EXPECT_TRUE(is_stored(1)) << "the checkpoint before refers to it";
    ASSERT_EQ(checkpoint(*master).problem, "");
    EXPECT_FALSE(is_stored(1));
    EXPECT_TRUE(is_stored(2));
    EXPECT_TRUE(fs::exists(blobs_path(folder)));
    // It is written again for the next edit that refers to it.
    replace(*master, 1);
    EXPECT_TRUE(is_stored(1));
    const Hash128 hash = master->authority.scene().state_hash();
    master.reset();
    const auto again = start(2);
    EXPECT_EQ(again->authority.scene().state_hash(), hash);
    EXPECT_TRUE(again->recovery.losses.empty()) << again->recovery.losses.at(0);
}

TEST_F(StoredBlobsTest, OfEditsSinceTheOlderCheckpointStay) {
    auto master = run(1);
    create(*master, 1);
    ASSERT_EQ(checkpoint(*master).problem, "");
    replace(*master, 2);
    replace(*master, 3);  // 2 is in this segment alone, once the history forgets it
    fill_history(*master);
    ASSERT_EQ(checkpoint(*master).problem, "");
    for (const std::uint32_t number : {1u, 2u, 3u}) EXPECT_TRUE(is_stored(number)) << number;
    replace(*master, 4);
    EXPECT_TRUE(is_stored(4)) << "after the checkpoint";
    const Hash128 hash = master->authority.scene().state_hash();
    master.reset();
    // The newer checkpoint is lost: the older one and the journal since then must do.
    const auto newest = session_files(folder).checkpoints.back();
    write(checkpoint_path(folder, newest), "damaged");
    const auto again = start(2);
    EXPECT_EQ(again->authority.scene().state_hash(), hash);
    for (const std::string& loss : again->recovery.losses)
        EXPECT_EQ(loss.find("blob"), std::string::npos) << loss;
}

// A file whose sync failed can often be read until the next start, and not after it.
TEST_F(StoredBlobsTest, ThatTheDiskDidNotTakeAreWrittenAgainBeforeTheNextCheckpoint) {
    auto master = run(1);
    create(*master, 1);
    ++id.value;
    create(*master, 2);
    for (const std::uint32_t number : {1u, 2u})
        write(scene::blob_path(blobs_path(folder), scene::reference(blob(number))), "lost later..");
    master->stored->sync_failed(blob(1).hash());
    ASSERT_EQ(checkpoint(*master).problem, "");
    EXPECT_TRUE(is_stored(1));
    EXPECT_FALSE(is_stored(2)) << "nothing is written again without need";
    master->stored->sync_failed_of_all();
    ASSERT_EQ(checkpoint(*master).problem, "");
    EXPECT_TRUE(is_stored(2));

    master->stored->sync_failed(blob(1).hash());
    const fs::path obstacle = scene::blob_path(blobs_path(folder), scene::reference(blob(1))).string() + "." +
                              std::to_string(::getpid()) + ".again.part";
    fs::create_directory(obstacle);
    EXPECT_NE(checkpoint(*master).problem, "") << "it would refer to what is not on disk";
    fs::remove(obstacle);
    EXPECT_EQ(checkpoint(*master).problem, "");
}

// After a restart nothing is known of the checkpoints that are there.
TEST_F(StoredBlobsTest, StayUntilTwoCheckpointsWereWritten) {
    auto master = run(1);
    create(*master, 1);
    replace(*master, 2);
    fill_history(*master);
    ASSERT_EQ(checkpoint(*master).problem, "");
    master.reset();
    master = run(2);
    ASSERT_EQ(checkpoint(*master).problem, "");
    EXPECT_TRUE(is_stored(1));
    ASSERT_EQ(checkpoint(*master).problem, "");
    EXPECT_FALSE(is_stored(1));
    EXPECT_TRUE(is_stored(2));
}

TEST_F(StoredBlobsTest, LeftoversOfInterruptedWritesAreRemovedAtTheStart) {
    start(1).reset();
    const fs::path part = blobs_path(folder) / "0123.77.part", checkpoint = folder / "checkpoint-000009.part",
                   fresh = folder / "journal-000001.damaged", old = folder / "journal-000001.tail-16";
    for (const fs::path& path : {part, checkpoint, fresh, old}) write(path, "content");
    fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::days(8));
    start(2).reset();
    EXPECT_FALSE(fs::exists(part));
    EXPECT_FALSE(fs::exists(checkpoint));
    EXPECT_TRUE(fs::exists(fresh)) << "someone may want to look at it";
    EXPECT_FALSE(fs::exists(old));
}

}  // namespace
}  // namespace tessera::master
