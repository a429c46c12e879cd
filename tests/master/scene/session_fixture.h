#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "master/scene/journal.h"
#include "master/scene/recovery.h"
#include "tests/scene/random_edits.h"

namespace tessera::master {

namespace fs = std::filesystem;

// A folder for a session, and members who do the same things in every master that is asked: what they do
// follows from a seed and the scene alone.
struct SessionFixture : testing::Test {
    SessionFixture() { fs::remove_all(folder); }
    ~SessionFixture() override { fs::remove_all(folder); }

    struct Master {
        explicit Master(std::uint64_t epoch) : authority(epoch, blobs) {
            blobs->insert(scene::RandomEdits::mesh_bytes().bytes());
        }
        std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
        SceneAuthority authority;
        std::unique_ptr<SessionFolder> files;
        std::shared_ptr<StoredBlobs> stored;
        std::unique_ptr<Journal> journal;
        Recovery recovery;
    };

    // As tessera-master starts with --session.
    std::unique_ptr<Master> start(std::uint64_t epoch) {
        auto master = std::make_unique<Master>(epoch);
        master->files = std::make_unique<SessionFolder>(folder);
        master->recovery = recover(*master->files, master->authority, *master->blobs);
        master->stored = std::make_shared<StoredBlobs>(folder, master->blobs);
        master->journal = std::make_unique<Journal>(folder, master->blobs, master->recovery.next_segment,
                                                    master->stored, master->files->lease());
        master->authority.record_to(master->journal.get());
        return master;
    }

    static constexpr std::uint64_t Members = 3;
    static SessionId session(std::uint64_t member) { return SessionId{member + 1}; }
    static void join_all(SceneAuthority& authority) {
        for (std::uint64_t member = 0; member < Members; ++member)
            authority.join(session(member), "user " + std::to_string(member), 100 + member);
    }

    // Step `step` of a session, the same in every master that did those before it.
    static EditAnswer act(SceneAuthority& authority, std::uint64_t step) {
        CounterRandom random(step, 77);
        const std::uint64_t member = random.below(Members);
        const SessionId who = session(member);
        const std::uint64_t sequence = authority.last_sequence(who) + 1;
        const std::uint64_t first = authority.join(who, "user " + std::to_string(member), 100 + member).first;
        scene::Edit edit{.session = who, .sequence = sequence, .edit_group = (step / 40) % 3};
        const std::uint64_t dice = random.below(12);
        if (dice == 0) {
            edit.undo = scene::UndoLatest;
        } else if (dice == 1) {
            edit.undo = scene::RedoLatest;
        } else {
            scene::RandomEdits edits(step, first + step * 10);
            edit.entries = edits.next(authority.scene());
        }
        return authority.submit(
            edit, {"member " + std::to_string(member), "user", static_cast<std::int64_t>(step)});
    }

    static void expect_same(const SceneAuthority& a, const SceneAuthority& b) {
        ASSERT_EQ(a.scene().state_hash(), b.scene().state_hash());
        ASSERT_TRUE(scene::difference(a.scene(), b.scene()).entries.empty());
        const auto left = a.history(1000), right = b.history(1000);
        ASSERT_EQ(left.size(), right.size());
        for (std::size_t i = 0; i < left.size(); ++i) {
            ASSERT_EQ(left[i].number, right[i].number);
            ASSERT_EQ(left[i].name, right[i].name);
            ASSERT_EQ(left[i].time, right[i].time);
            ASSERT_EQ(left[i].edits, right[i].edits);
            ASSERT_EQ(left[i].text, right[i].text);
            ASSERT_EQ(left[i].undoes, right[i].undoes);
            ASSERT_EQ(left[i].undone_by, right[i].undone_by);
        }
        for (const auto& [id, object] : a.scene().objects()) {
            const auto ours = a.writers(id), theirs = b.writers(id);
            ASSERT_EQ(ours.size(), theirs.size());
            for (std::size_t i = 0; i < ours.size(); ++i) {
                ASSERT_EQ(ours[i].field, theirs[i].field);
                ASSERT_EQ(ours[i].transaction, theirs[i].transaction);
                ASSERT_EQ(ours[i].name, theirs[i].name);
            }
        }
    }

    static std::string read(const fs::path& path) {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    static void write(const fs::path& path, const std::string& content) {
        std::ofstream(path, std::ios::binary) << content;
    }
    static bool mentions(const Recovery& recovery, const std::string& text) {
        const auto names = [&](const std::string& note) { return note.find(text) != std::string::npos; };
        return std::any_of(recovery.notes.begin(), recovery.notes.end(), names) ||
               std::any_of(recovery.losses.begin(), recovery.losses.end(), names);
    }

    const fs::path folder =
        fs::temp_directory_path() / ("tessera-session-test-" + std::to_string(::getpid()));
};

}  // namespace tessera::master
