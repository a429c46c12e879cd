// Units in, film out.
#include "tests/node/machine_fixture.h"

namespace tessera::node {
namespace {

using test::seconds;
using wire::ReleaseReason;

struct MachineWorkTest : test::MachineTest {
    MachineWorkTest() { synced(); }

    wire::UnitReleased only_release() {
        const auto released = sent<wire::UnitReleased>();
        if (released.size() != 1) throw std::logic_error("expected one release");
        return released[0];
    }
    // The worker stopped unit `id` after its first 5 of 8 samples.
    void stopped(std::uint64_t id) {
        UnitOutcome outcome;
        outcome.result.status = backend::RenderStatus::Stopped;
        for (const auto& block : frame::aligned_blocks(0, 5)) {
            outcome.result.blocks.push_back(frame::FilmTile({0, 0, 8, 8}, block, {frame::Channel::Radiance}));
        }
        machine->finished(UnitId{id}, std::move(outcome), now);
        collect();
    }
};

TEST_F(MachineWorkTest, CreditsAreAbsolute) {
    for (std::uint64_t id = 1; id <= 3; ++id) work(id);
    wire::Heartbeat beat = last_heartbeat();
    EXPECT_EQ(beat.in_flight, (std::vector{UnitId{1}, UnitId{2}, UnitId{3}}));
    EXPECT_EQ(beat.free_slots, 1u);
    EXPECT_EQ(beat.last_work_sequence, 3u);
    EXPECT_EQ(beat.phase, session::NodePhase::Rendering);
    EXPECT_EQ(take<Render>().size(), 2u);
    finish(1);
    beat = last_heartbeat();
    EXPECT_EQ(beat.in_flight.size(), 3u);  // its film is not out yet
    EXPECT_EQ(beat.free_slots, 1u);
    EXPECT_EQ(beat.progress, 8u * 64u);
    EXPECT_EQ(take<Render>().size(), 1u);
    machine->film_sent(UnitId{1});
    collect();
    beat = last_heartbeat();
    EXPECT_EQ(beat.in_flight, (std::vector{UnitId{2}, UnitId{3}}));
    EXPECT_EQ(beat.free_slots, 2u);
}

TEST_F(MachineWorkTest, FilmNamesItsUnitViewAndVersion) {
    work(1);
    UnitOutcome outcome = done(unit(1));
    outcome.result.rays = 99;
    outcome.busy = seconds(2);
    machine->finished(UnitId{1}, std::move(outcome), now);
    collect();
    const auto films = take<SendFilm>();
    ASSERT_EQ(films.size(), 1u);
    ASSERT_EQ(films[0].parts.size(), 1u);
    const wire::FilmPart& part = films[0].parts[0];
    EXPECT_EQ(part.unit, UnitId{1});
    EXPECT_EQ(part.version, builder.scene().version());
    EXPECT_EQ(part.rays, 99u);
    EXPECT_EQ(part.busy_ns, 2'000'000'000u);
    EXPECT_EQ(part.film.block, (frame::SampleBlock{0, 3}));
}

TEST_F(MachineWorkTest, RepeatedAndOutdatedWorkIsDropped) {
    send(wire::Work{5, unit(1)});
    send(wire::Work{5, unit(1)});
    send(wire::Work{4, unit(2)});
    send(wire::Work{6, unit(1)});
    const wire::Heartbeat beat = last_heartbeat();
    EXPECT_EQ(beat.in_flight, std::vector{UnitId{1}});
    EXPECT_EQ(beat.last_work_sequence, 6u);
    EXPECT_EQ(take<Render>().size(), 1u);
}

TEST_F(MachineWorkTest, UnitsThatCannotBeRenderedAreReleasedWithAReason) {
    const auto reason = [&](auto change) {
        view::WorkUnit bad = unit(100 + sequence);
        change(bad);
        send(wire::Work{++sequence, bad});
        return only_release().reason;
    };
    EXPECT_EQ(reason([](auto& bad) { bad.view = ViewId{9}; }), ReleaseReason::UnknownView);
    EXPECT_EQ(reason([](auto& bad) { bad.revision = 9; }), ReleaseReason::UnknownView);
    EXPECT_EQ(reason([](auto& bad) { bad.version.number = 9; }), ReleaseReason::OtherVersion);
    EXPECT_EQ(reason([](auto& bad) { bad.version.epoch = 9; }), ReleaseReason::OtherVersion);
    EXPECT_EQ(reason([](auto& bad) { bad.tile = {60, 0, 8, 8}; }), ReleaseReason::Failed);
    EXPECT_EQ(reason([](auto& bad) { bad.tile = {0, 0, 0, 8}; }), ReleaseReason::Failed);
    EXPECT_EQ(reason([](auto& bad) {
                  bad.tile = {-2147483647, 0, 2147483647, 2147483647};
              }),
              ReleaseReason::Failed);
    EXPECT_EQ(reason([](auto& bad) { bad.block = {1, 1}; }), ReleaseReason::Failed);
    EXPECT_EQ(reason([](auto& bad) { bad.block = {0, 40}; }), ReleaseReason::Failed);
    EXPECT_TRUE(take<Render>().empty());
    EXPECT_EQ(last_heartbeat().free_slots, 4u);
}

TEST_F(MachineWorkTest, AnInvalidViewIsNotOpened) {
    view::View bad = view;
    bad.id = ViewId{2};
    bad.window = {0, 0, 65, 64};
    send(wire::OpenView{bad});
    bad.window = {0, 0, 64, 64};
    bad.channels = {frame::Channel::Depth};  // the back-end has only radiance
    send(wire::OpenView{bad});
    EXPECT_EQ(sent<wire::Notice>().size(), 2u);
    bad.channels = view.channels;
    bad.renderer = view::Renderer::Raster;  // which draws, and the back-end traces
    send(wire::OpenView{bad});
    const auto refusals = sent<wire::Notice>();
    ASSERT_EQ(refusals.size(), 1u);
    EXPECT_NE(refusals.back().text.find("the renderer raster"), std::string::npos) << refusals.back().text;
    view::WorkUnit unit_of_it = unit(1);
    unit_of_it.view = bad.id;
    send(wire::Work{++sequence, unit_of_it});
    EXPECT_EQ(only_release().reason, ReleaseReason::UnknownView);
}

TEST_F(MachineWorkTest, UnitsFarBeyondTheCreditsAreReleased) {
    for (std::uint64_t id = 1; id <= 200; ++id) work(id);
    const auto released = sent<wire::UnitReleased>();
    EXPECT_GT(released.size(), 100u);
    EXPECT_EQ(released.size() + last_heartbeat().in_flight.size(), 200u);
}

TEST_F(MachineWorkTest, CancellingReleasesWaitingUnitsAndStopsRunningOnes) {
    for (std::uint64_t id = 1; id <= 3; ++id) work(id);
    send(wire::CancelUnits{{UnitId{1}, UnitId{3}, UnitId{77}}});
    EXPECT_EQ(only_release().unit, UnitId{3});
    const auto stops = take<StopUnit>();
    ASSERT_EQ(stops.size(), 1u);
    EXPECT_EQ(stops[0].unit, UnitId{1});

    stopped(1);
    const auto films = take<SendFilm>();
    ASSERT_EQ(films.size(), 1u);
    ASSERT_EQ(films[0].parts.size(), 2u);  // blocks of 4 and 1
    EXPECT_EQ(films[0].parts[0].units, 0u) << "no complete unit";
    EXPECT_TRUE(sent<wire::UnitReleased>().empty());  // after its film
    machine->film_sent(UnitId{1});
    collect();
    EXPECT_EQ(only_release().reason, ReleaseReason::Cancelled);
}

TEST_F(MachineWorkTest, AUnitThatEndedBeforeItWasStoppedSendsItsFilm) {
    work(1);
    send(wire::CancelUnits{{UnitId{1}}});
    finish(1);
    EXPECT_EQ(take<SendFilm>().size(), 1u);
    machine->film_sent(UnitId{1});
    collect();
    EXPECT_TRUE(sent<wire::UnitReleased>().empty());
}

TEST_F(MachineWorkTest, ANewRevisionEndsTheUnitsOfTheOldWithoutFilm) {
    for (std::uint64_t id = 1; id <= 3; ++id) work(id);
    actions.clear();
    ++view.revision;
    send(wire::OpenView{view});
    EXPECT_EQ(only_release().unit, UnitId{3});
    EXPECT_EQ(take<StopUnit>().size(), 2u);
    stopped(1);
    EXPECT_TRUE(take<SendFilm>().empty());
    EXPECT_EQ(only_release().reason, ReleaseReason::Cancelled);

    view::View old = view;
    --old.revision;
    send(wire::OpenView{old});  // late: the newer one stays
    work(4);
    EXPECT_TRUE(sent<wire::UnitReleased>().empty());
}

TEST_F(MachineWorkTest, AClosedViewHasNoUnits) {
    work(1);
    send(wire::CloseView{view.id});
    EXPECT_EQ(take<StopUnit>().size(), 1u);
    work(2);
    EXPECT_EQ(only_release().reason, ReleaseReason::UnknownView);
}

struct HeldUnitsTest : MachineWorkTest {
    static constexpr frame::SampleBlock First{0, 3}, Second{8, 3};

    HeldUnitsTest() {
        ++view.revision;
        send(wire::OpenView{view, seconds(5)});
        for (const std::uint64_t id : {1u, 2u}) {
            view::WorkUnit half = unit(id);
            half.block = id == 1 ? First : Second;
            send(wire::Work{++sequence, half});
        }
        actions.clear();
    }
};

TEST_F(HeldUnitsTest, HalvesOfABlockAreSentMerged) {
    finish(1, First);
    EXPECT_TRUE(take<SendFilm>().empty());
    const wire::Heartbeat beat = last_heartbeat();
    EXPECT_EQ(beat.in_flight.size(), 2u) << "the master still counts on it";
    EXPECT_EQ(beat.free_slots, 3u) << "held film takes no slot";
    finish(2, Second);
    const auto films = take<SendFilm>();
    ASSERT_EQ(films.size(), 1u);
    ASSERT_EQ(films[0].parts.size(), 1u);
    EXPECT_EQ(films[0].parts[0].film.block, (frame::SampleBlock{0, 4}));
    EXPECT_EQ(films[0].parts[0].units, 2u);
    for (const UnitId unit : films[0].units) machine->film_sent(unit);
    collect();
    EXPECT_TRUE(last_heartbeat().in_flight.empty());
}

TEST_F(HeldUnitsTest, FilmIsNotHeldForEver) {
    const TimePoint begin = now;
    finish(1, First);
    for (int i = 0; i < 9; ++i) pass(std::chrono::milliseconds(500));
    EXPECT_TRUE(take<SendFilm>().empty());
    EXPECT_EQ(machine->next_event(now), begin + seconds(5));
    pass(seconds(1));
    EXPECT_EQ(take<SendFilm>().size(), 1u);
}

TEST_F(HeldUnitsTest, FilmIsSentWhenTheOtherHalfIsCancelled) {
    finish(1, First);
    send(wire::CancelUnits{{UnitId{2}}});  // being rendered: it stops
    EXPECT_EQ(take<SendFilm>().size(), 1u);
}

TEST_F(HeldUnitsTest, CancelledFilmIsNotSent) {
    finish(1, First);
    send(wire::CancelUnits{{UnitId{1}}});
    EXPECT_EQ(only_release().unit, UnitId{1});
    finish(2, Second);
    const auto films = take<SendFilm>();
    ASSERT_EQ(films.size(), 1u);
    EXPECT_EQ(films[0].units, std::vector{UnitId{2}});
    send(wire::CancelUnits{{UnitId{2}}});  // waits for the link
    ASSERT_EQ(take<WithdrawFilm>().size(), 1u);
    machine->film_withdrawn(UnitId{2});
    collect();
    EXPECT_EQ(only_release().unit, UnitId{2});
}

TEST_F(HeldUnitsTest, ANewRevisionDropsIt) {
    finish(1, First);
    ++view.revision;
    send(wire::OpenView{view});
    EXPECT_TRUE(take<SendFilm>().empty());
    EXPECT_EQ(only_release().unit, UnitId{1});
}

TEST_F(MachineWorkTest, AFailingUnitIsReleasedWithTheCommandThatReproducesIt) {
    work(1);
    UnitOutcome outcome;
    outcome.error = "unit 1 failed: replay it";
    machine->finished(UnitId{1}, std::move(outcome), now);
    collect();
    const wire::UnitReleased released = only_release();
    EXPECT_EQ(released.reason, ReleaseReason::Failed);
    EXPECT_EQ(released.message, "unit 1 failed: replay it");
}

TEST_F(MachineWorkTest, ANewVersionReleasesWaitingUnitsAndAcceptsItsOwn) {
    for (std::uint64_t id = 1; id <= 3; ++id) work(id);
    actions.clear();
    const scene::ChangeList list = builder.edit({scene::Create{ObjectId{50}, scene::Camera{}}});
    send(wire::Changes{list});
    EXPECT_EQ(take<BuildScene>().size(), 1u);
    EXPECT_EQ(only_release().unit, UnitId{3});
    send(wire::Work{++sequence, unit(4, list.from)});
    EXPECT_EQ(only_release().reason, ReleaseReason::OtherVersion);
    send(wire::Work{++sequence, unit(5, list.to)});
    EXPECT_TRUE(sent<wire::UnitReleased>().empty());
    finish(1);
    finish(2);
    EXPECT_TRUE(take<Render>().empty());  // not before the build is done
    machine->built({}, now);
    collect();
    const auto renders = take<Render>();
    ASSERT_EQ(renders.size(), 1u);
    EXPECT_EQ(renders[0].unit.id, UnitId{5});
}

}  // namespace
}  // namespace tessera::node
