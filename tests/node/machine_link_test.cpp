// Joining, heartbeats and reconnection, leaving.
#include "tests/node/machine_fixture.h"

namespace tessera::node {
namespace {

using State = NodeStateMachine::State;
using test::milliseconds;
using test::seconds;
struct MachineLinkTest : test::MachineTest {};

TEST_F(MachineLinkTest, SendsHelloFirstAndAnswersWelcomeWithItsTokenAndAHeartbeat) {
    EXPECT_EQ(machine->state(), State::Joining);
    const auto hellos = sent<wire::Hello>();
    ASSERT_EQ(hellos.size(), 1u);
    EXPECT_EQ(hellos[0].peer, wire::PeerKind::Node);
    EXPECT_EQ(hellos[0].concurrent_units, 2u);
    EXPECT_EQ(hellos[0].resume_token, 0u);
    welcome();
    EXPECT_EQ(machine->state(), State::Syncing);
    const auto bulk = take<OpenBulk>();
    ASSERT_EQ(bulk.size(), 1u);
    EXPECT_EQ(bulk[0].token, 101u);
    const wire::Heartbeat beat = last_heartbeat();
    EXPECT_EQ(beat.phase, session::NodePhase::Syncing);
    EXPECT_EQ(beat.free_slots, 4u);
}

TEST_F(MachineLinkTest, GoesThroughItsStates) {
    synced();
    EXPECT_EQ(machine->state(), State::Idle);
    work(1);
    EXPECT_EQ(machine->state(), State::Working);
    finish(1);
    EXPECT_EQ(machine->state(), State::Working);  // until the film is out
    machine->film_sent(UnitId{1});
    EXPECT_EQ(machine->state(), State::Idle);
    send(wire::Leave{});
    EXPECT_EQ(machine->state(), State::Left);
}

TEST_F(MachineLinkTest, ATimeoutReconnectsWithBackoffAndResumes) {
    synced();
    pass(milliseconds(3001));
    EXPECT_EQ(machine->state(), State::Joining);
    EXPECT_TRUE(take<Reconnect>().empty());
    std::vector<Duration> pauses;
    for (int i = 0; i < 4; ++i) {
        const TimePoint lost = now;
        while (take<Reconnect>().empty()) pass(milliseconds(10));
        pauses.push_back(now - lost);
        const auto hellos = sent<wire::Hello>();
        ASSERT_EQ(hellos.size(), 1u);
        EXPECT_EQ(hellos[0].resume_token, 101u);
        pass(milliseconds(3001));
    }
    for (std::size_t i = 1; i < pauses.size(); ++i) EXPECT_GT(pauses[i], pauses[i - 1]);
}

TEST_F(MachineLinkTest, WelcomedUnderTheSameNumberItKeepsItsUnits) {
    synced();
    work(1);
    send(wire::Unknown{});
    EXPECT_EQ(machine->state(), State::Joining);
    EXPECT_EQ(take<PauseBulk>().size(), 1u);
    EXPECT_EQ(sent<wire::Hello>().size(), 1u);
    send(wire::Unknown{});
    EXPECT_TRUE(sent<wire::Hello>().empty());  // the answer has not arrived yet
    actions.clear();
    welcome();
    const wire::Heartbeat beat = last_heartbeat();
    EXPECT_EQ(beat.in_flight, std::vector{UnitId{1}});
    EXPECT_EQ(beat.version, builder.scene().version());
    EXPECT_TRUE(take<StopUnit>().empty());
    sequence = 0;  // numbers start again
    work(2);
    EXPECT_EQ(last_heartbeat().in_flight, (std::vector{UnitId{1}, UnitId{2}}));
}

TEST_F(MachineLinkTest, AnotherNumberDropsUnitsAndFilmButKeepsTheScene) {
    synced();
    work(1);
    actions.clear();
    welcome(2);
    EXPECT_EQ(take<DiscardPendingFilm>().size(), 1u);
    EXPECT_EQ(take<StopUnit>().size(), 1u);
    const wire::Heartbeat beat = last_heartbeat();
    EXPECT_TRUE(beat.in_flight.empty());
    EXPECT_EQ(beat.version, builder.scene().version());
    finish(1);  // arrives late and is ignored
    EXPECT_TRUE(take<SendFilm>().empty());
    EXPECT_TRUE(sent<wire::UnitReleased>().empty());
}

TEST_F(MachineLinkTest, AnotherEpochDropsTheSceneToo) {
    synced();
    welcome(2, Epoch + 1);
    EXPECT_EQ(last_heartbeat().version, Version{});
    EXPECT_EQ(machine->state(), State::Syncing);
}

TEST_F(MachineLinkTest, ALateWelcomeUnderALowerNumberIsIgnored) {
    welcome(5);
    actions.clear();
    welcome(4);
    EXPECT_TRUE(take<OpenBulk>().empty());
}

TEST_F(MachineLinkTest, HeartbeatsComeInTimeAndEchoTheMasters) {
    synced();
    pass(milliseconds(900));
    EXPECT_TRUE(sent<wire::Heartbeat>().empty());
    send(wire::Heartbeat{.sent_at = 77});
    pass(milliseconds(150));
    const wire::Heartbeat beat = last_heartbeat();
    EXPECT_EQ(beat.echo_sent_at, 77);
    EXPECT_EQ(beat.echo_delay, Duration(milliseconds(150)).count());
    const auto bulk = take<SendBulk>();
    ASSERT_EQ(bulk.size(), 1u);  // the token again, in case it got lost
    EXPECT_TRUE(std::holds_alternative<wire::BulkHello>(bulk[0].message));
}

TEST_F(MachineLinkTest, ARefusalEndsItWithTheReason) {
    send(wire::Refusal{"protocol 2 is spoken here"});
    EXPECT_EQ(machine->state(), State::Left);
    EXPECT_NE(machine->failure_text().find("protocol 2 is spoken here"), std::string::npos);
}

TEST_F(MachineLinkTest, DrainingFinishesRunningUnitsAndReleasesTheOthers) {
    synced();
    for (std::uint64_t id = 1; id <= 4; ++id) work(id);
    EXPECT_EQ(take<Render>().size(), 2u);
    actions.clear();
    machine->leave("asked to stop", Drain::Finish, now);
    collect();
    const auto released = sent<wire::UnitReleased>();
    ASSERT_EQ(released.size(), 2u);
    EXPECT_EQ(released[0].unit, UnitId{3});
    EXPECT_EQ(released[0].reason, wire::ReleaseReason::Leaving);
    const wire::Heartbeat beat = last_heartbeat();
    EXPECT_EQ(beat.phase, session::NodePhase::Leaving);
    EXPECT_EQ(beat.free_slots, 0u);
    EXPECT_TRUE(take<StopUnit>().empty());

    work(5);
    EXPECT_EQ(sent<wire::UnitReleased>().at(0).reason, wire::ReleaseReason::Leaving);
    finish(1);
    finish(2);
    EXPECT_EQ(take<SendFilm>().size(), 2u);
    EXPECT_TRUE(sent<wire::Goodbye>().empty());
    machine->film_sent(UnitId{1});
    machine->film_sent(UnitId{2});
    collect();
    const auto goodbyes = sent<wire::Goodbye>();
    ASSERT_EQ(goodbyes.size(), 1u);
    EXPECT_EQ(goodbyes[0].units_sent, (std::vector{UnitId{1}, UnitId{2}}));
    EXPECT_EQ(machine->state(), State::Left);
}

TEST_F(MachineLinkTest, HandingBackStopsRunningUnitsAndSendsTheirWholeBlocks) {
    synced();
    for (std::uint64_t id = 1; id <= 3; ++id) work(id);
    EXPECT_EQ(take<Render>().size(), 2u);
    actions.clear();
    machine->leave("asked to stop", Drain::HandBack, now);
    collect();
    EXPECT_EQ(take<StopUnit>().size(), 2u);
    EXPECT_EQ(sent<wire::UnitReleased>().size(), 1u) << "the one that waited";

    // The first has half of its samples, the second none.
    UnitOutcome half = done(unit(1));
    half.result.status = backend::RenderStatus::Stopped;
    half.result.blocks[0] = frame::FilmTile(unit(1).tile, {0, 2}, {frame::Channel::Radiance});
    machine->finished(UnitId{1}, std::move(half), now);
    UnitOutcome none;
    none.result.status = backend::RenderStatus::Stopped;
    machine->finished(UnitId{2}, std::move(none), now);
    collect();
    ASSERT_EQ(take<SendFilm>().size(), 1u);
    machine->film_sent(UnitId{1});
    collect();
    const auto released = sent<wire::UnitReleased>();
    ASSERT_EQ(released.size(), 2u);
    for (const auto& release : released) EXPECT_EQ(release.reason, wire::ReleaseReason::Leaving);
    EXPECT_EQ(sent<wire::Goodbye>().size(), 1u);
    EXPECT_EQ(machine->state(), State::Left);
}

TEST_F(MachineLinkTest, HandingBackEndsAfterThreeSecondsWhateverTheLink) {
    synced();
    work(1);
    machine->leave("asked to stop", Drain::HandBack, now);
    pass(LeaveLimit - milliseconds(1));
    EXPECT_EQ(machine->state(), State::Leaving) << "the unit has not answered yet";
    EXPECT_LE(machine->next_event(now), now + milliseconds(1));
    pass(milliseconds(1));
    EXPECT_EQ(machine->state(), State::Left);
}

TEST_F(MachineLinkTest, ASecondLeaveIsImmediate) {
    synced();
    work(1);
    actions.clear();
    machine->leave("asked to stop", Drain::Finish, now);
    machine->leave("asked again", Drain::Finish, now);
    collect();
    EXPECT_EQ(take<StopUnit>().size(), 1u);
    const auto goodbyes = sent<wire::Goodbye>();
    ASSERT_EQ(goodbyes.size(), 1u);
    EXPECT_TRUE(goodbyes[0].units_sent.empty());
    EXPECT_EQ(machine->state(), State::Left);
}

TEST_F(MachineLinkTest, UnexpectedMessagesAreCountedAndHarmless) {
    synced();
    send(wire::Hello{});
    send(wire::StatusReply{});
    machine->bulk(wire::BlobRequest{}, now);
    machine->malformed("nonsense", now);
    EXPECT_EQ(machine->counters().malformed_messages, 4u);
    EXPECT_EQ(machine->state(), State::Idle);
}

}  // namespace
}  // namespace tessera::node
