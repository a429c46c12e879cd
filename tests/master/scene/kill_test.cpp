#include <sys/wait.h>

#include <csignal>

#include "master/scene/checkpoint_writer.h"
#include "tests/master/scene/session_fixture.h"

namespace tessera::master {
namespace {

struct KillTest : SessionFixture {
    // Edits without end, and says after each answer how far it is; a checkpoint now and then.
    [[noreturn]] void live_until_killed(std::uint64_t epoch, std::uint64_t step, int acknowledge) {
        auto master = start(epoch);
        join_all(master->authority);
        CheckpointWriter writer(folder);
        for (;; ++step) {
            // An edit that changed nothing is no transaction, and nothing is kept of it.
            const bool is_kept = act(master->authority, step).transaction != 0;
            if (is_kept && ::write(acknowledge, &step, sizeof step) != sizeof step) _exit(1);
            if (step % 50 == 0 && !writer.busy())
                writer.start({master->journal->start_segment(), {}, master->authority.save(), {}});
        }
    }
};

// After kill -9 at random moments every acknowledged edit is there, and nothing but what was asked for: the
// scene is the one that the same steps give without a death.
TEST_F(KillTest, NoAcknowledgedEditIsLost) {
    CounterRandom random(11);
    std::uint64_t acknowledged = 0, rounds_with_edits = 0;
    for (std::uint64_t round = 1; round <= 25; ++round) {
        int pipes[2];
        ASSERT_EQ(::pipe(pipes), 0);
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            ::close(pipes[0]);
            live_until_killed(round, acknowledged + 1, pipes[1]);
        }
        ::close(pipes[1]);
        // Every third dies at any time, so also while it recovers; the others while they edit.
        const std::uint64_t before = acknowledged;
        std::uint64_t step = 0;
        if (round % 3 != 0 && ::read(pipes[0], &step, sizeof step) == sizeof step) acknowledged = step;
        ::usleep(static_cast<useconds_t>(random.below(15000)));
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        while (::read(pipes[0], &step, sizeof step) == sizeof step) acknowledged = step;
        ::close(pipes[0]);
        rounds_with_edits += acknowledged > before;

        const SessionFolder files(folder);
        Master again(1000 + round), reference(1);
        const Recovery recovery = recover(files, again.authority, *again.blobs);
        ASSERT_FALSE(mentions(recovery, "lost")) << recovery.losses.back();
        if (acknowledged == 0) continue;
        // The time of an edit is its step: the latest of all is the last that was recorded.
        std::uint64_t steps = 0;
        for (const auto& entry : again.authority.history(1000))
            steps = std::max(steps, static_cast<std::uint64_t>(entry.time));
        ASSERT_GE(steps, acknowledged);
        join_all(reference.authority);
        for (std::uint64_t i = 1; i <= steps; ++i) act(reference.authority, i);
        ASSERT_EQ(again.authority.scene().state_hash(), reference.authority.scene().state_hash())
            << "round " << round;
        acknowledged = steps;
    }
    EXPECT_GT(rounds_with_edits, 10u);
    EXPECT_GT(acknowledged, 500u);
}

}  // namespace
}  // namespace tessera::master
