// The dispatcher's messages to nodes, and its handling of theirs.
#include "master/render/dispatcher.h"

#include <gtest/gtest.h>

#include "mediator/wire/envelope.h"

namespace tessera::master {
namespace {

// Records messages instead of sending them.
class RecordingChannel final : public net::Channel {
  public:
    net::SendResult send(net::Link, net::PeerId, net::Bytes&& bytes) override {
        sent.push_back(*wire::decode_control(bytes));
        return net::SendResult::Sent;
    }
    net::Received receive(TimePoint) override { return net::NoMessage::Timeout; }
    void wake() override {}
    void close() override {}

    template <class Message>
    std::vector<Message> all() const {
        std::vector<Message> found;
        for (const wire::ControlMessage& message : sent) {
            if (const auto* one = std::get_if<Message>(&message)) found.push_back(*one);
        }
        return found;
    }
    std::vector<wire::ControlMessage> sent;
};

struct DispatcherTest : testing::Test {
    static constexpr Version Scene{1, 1};
    SteadyClock clock;
    TimePoint now = clock.now();
    RecordingChannel channel;
    Outbox outbox{channel};
    NodeTable nodes{{}, {}};
    std::vector<std::string> events;
    std::vector<Event> details;
    Dispatcher dispatcher{std::chrono::seconds(5), clock, nodes, outbox, [this](const Event& event) {
                              event.is_detail ? details.push_back(event) : events.push_back(event.text);
                          }};

    NodeRecord& add_node(std::uint64_t number, std::uint32_t slots) {
        wire::Hello hello{.name = "node-" + std::to_string(number), .channels = {frame::Channel::Color}};
        hello.concurrent_units = slots;
        NodeRecord& node = nodes.add(NodeId{number}, number, number, "node", std::move(hello), now);
        node.bulk = 100 + number;
        node.reported = node.state.version = Scene;
        node.state.free_slots = slots;
        return node;
    }
    view::View view(std::uint64_t id, std::int32_t edge) const {
        view::View view{.id = ViewId{id}, .revision = 1};
        view.width = view.height = static_cast<std::uint32_t>(edge);
        view.window = {0, 0, edge, edge};
        view.channels = {frame::Channel::Color};
        return view;
    }
    void begin(const view::View& view) {
        dispatcher.begin(view, {.window = view.window, .tile = 8, .spp = 4}, {Scene});
    }
    void deal(ViewId view) {
        auto capacities = dispatcher.capacities();
        dispatcher.deal(view, capacities, now);
    }
    static wire::FilmHead head(const view::WorkUnit& unit) {
        return {unit.id, unit.view, unit.revision, unit.version, unit.tile, unit.block};
    }
    bool admit(std::uint64_t node, const wire::FilmHead& film) {
        return dispatcher.admit(*nodes.find(NodeId{node}), film, 1000, now).has_value();
    }
    std::string quarantine_reason(std::uint64_t node) {
        const auto* entry = dispatcher.quarantine().find(nodes.find(NodeId{node})->identity(), now);
        return entry == nullptr ? "" : entry->reason;
    }
    MergeReport report(const view::WorkUnit& unit, FrameAssembler::Outcome outcome,
                       std::uint64_t node) const {
        MergeReport report{
            .node = NodeId{node}, .unit = unit.id, .view = unit.view, .revision = unit.revision};
        report.block = unit.block;
        report.units = 1;
        report.bytes = 1000;
        report.result.outcome = outcome;
        return report;
    }
};

TEST_F(DispatcherTest, CancellationsAreSplitIntoMessages) {
    add_node(1, 5000);
    begin(view(8, 640));  // 6,400 tiles
    deal(ViewId{8});
    const std::size_t dealt = channel.all<wire::Work>().size();
    ASSERT_GT(dealt, 2048u);
    dispatcher.cancel(ViewId{8});
    std::size_t cancelled = 0;
    for (const wire::CancelUnits& message : channel.all<wire::CancelUnits>()) {
        EXPECT_LE(message.units.size(), 1024u);
        cancelled += message.units.size();
    }
    EXPECT_EQ(cancelled, dealt);
}

TEST_F(DispatcherTest, ContradictingFilmIsReportedWithAReplayCommand) {
    add_node(1, 1);
    add_node(2, 0);
    begin(view(8, 8));
    deal(ViewId{8});
    const view::WorkUnit unit = channel.all<wire::Work>().at(0).unit;
    EXPECT_EQ(dispatcher.take(report(unit, FrameAssembler::Outcome::Merged, 1), now), Dispatcher::Taken::New);
    EXPECT_EQ(dispatcher.take(report(unit, FrameAssembler::Outcome::Conflict, 2), now),
              Dispatcher::Taken::Known);
    ASSERT_EQ(events.size(), 1u);
    EXPECT_NE(events[0].find("second: node-2"), std::string::npos) << events[0];
    EXPECT_NE(events[0].find("tessera probe SCENE --pixel 0,0 --sample 0"), std::string::npos) << events[0];
}

TEST_F(DispatcherTest, TheLogFollowsTheLifeOfAUnit) {
    add_node(1, 2);
    begin(view(8, 16));
    deal(ViewId{8});
    const auto work = channel.all<wire::Work>();
    ASSERT_EQ(work.size(), 2u);
    (void)dispatcher.take(report(work[0].unit, FrameAssembler::Outcome::Merged, 1), now);
    dispatcher.released(*nodes.find(NodeId{1}), {work[1].unit.id, wire::ReleaseReason::OtherVersion, ""},
                        now);
    const auto life_of = [&](UnitId unit) {
        std::vector<std::string> life;
        for (const Event& detail : details) {
            if (detail.about.unit != unit) continue;
            life.push_back(detail.text.substr(0, detail.text.find(" (")));
            EXPECT_EQ(detail.about.node, "node-1");
            EXPECT_EQ(detail.about.view, ViewId{8});
            EXPECT_EQ(detail.about.version, Scene);
        }
        return life;
    };
    const auto dealt = [](UnitId unit) { return "unit is dealt: unit " + std::to_string(unit.value); };
    const UnitId first = work[0].unit.id, second = work[1].unit.id;
    EXPECT_EQ(life_of(first), (std::vector<std::string>{dealt(first), "unit ends: merged"}));
    EXPECT_EQ(life_of(second), (std::vector<std::string>{dealt(second), "unit ends: refused"}));
}

TEST_F(DispatcherTest, PassesShareTheNodesSlots) {
    add_node(1, 3);
    begin(view(8, 16));
    begin(view(16, 16));
    auto capacities = dispatcher.capacities();
    dispatcher.deal(ViewId{8}, capacities, now);
    dispatcher.deal(ViewId{16}, capacities, now);
    EXPECT_EQ(channel.all<wire::Work>().size(), 3u) << "as many as the node has slots";
}

// Where units are short, a node has more of them in hand than it has slots: enough for the way to the master and back.
TEST_F(DispatcherTest, ShortUnitsGoBeyondTheSlotsOfANodeButNotWithoutEnd) {
    NodeRecord& node = add_node(1, 1);
    node.round_trip_seconds = 10.0;
    begin(view(8, 640));  // 6,400 tiles
    deal(ViewId{8});
    const auto first = channel.all<wire::Work>();
    ASSERT_EQ(first.size(), 1u) << "its rate is not known";
    MergeReport merged = report(first[0].unit, FrameAssembler::Outcome::Merged, 1);
    merged.pixel_samples = 64;
    merged.busy = std::chrono::milliseconds(10);
    (void)dispatcher.take(merged, now);
    begin(view(16, 640));
    node.state.free_slots = 0;
    deal(ViewId{8});
    EXPECT_EQ(channel.all<wire::Work>().size(), 1u) << "it takes nothing for now";
    node.state.free_slots = 2;
    deal(ViewId{8});
    node.state.free_slots = 0;
    for (int i = 0; i < 3; ++i) {
        auto capacities = dispatcher.capacities();
        for (const std::uint64_t id : {8u, 16u, 8u}) dispatcher.deal(ViewId{id}, capacities, now);
    }
    const std::size_t dealt = channel.all<wire::Work>().size();
    EXPECT_GT(dealt, 10u);
    EXPECT_LT(dealt, 40u);
}

TEST_F(DispatcherTest, UnitsOfALostNodeGoToTheNext) {
    NodeRecord& leaving = add_node(1, 1);
    begin(view(8, 8));
    deal(ViewId{8});
    const UnitId sent = channel.all<wire::Work>().at(0).unit.id;
    dispatcher.goodbye(leaving, {.reason = "stop", .units_sent = {}});
    leaving.leaving = true;
    add_node(2, 1);
    deal(ViewId{8});
    const auto work = channel.all<wire::Work>();
    ASSERT_EQ(work.size(), 2u);
    EXPECT_EQ(work[1].unit.tile, work[0].unit.tile);
    EXPECT_EQ(work[1].unit.block, work[0].unit.block);
    EXPECT_NE(work[1].unit.id, sent);
}

wire::UnitReleased failed(UnitId unit) {
    return {.unit = unit, .reason = wire::ReleaseReason::Failed, .message = "device lost"};
}

TEST_F(DispatcherTest, AUnitThatFailsGoesToAnotherNode) {
    NodeRecord& node = add_node(1, 1);
    begin(view(8, 8));
    deal(ViewId{8});
    const view::WorkUnit unit = channel.all<wire::Work>().at(0).unit;
    dispatcher.released(node, failed(unit.id), now);
    EXPECT_EQ(dispatcher.counts().refused, 1u);
    dispatcher.released(node, failed(unit.id), now);
    EXPECT_EQ(dispatcher.counts().refused, 1u) << "it does not hold the unit any more";
    add_node(2, 1);
    deal(ViewId{8});
    const auto work = channel.all<wire::Work>();
    EXPECT_TRUE(std::any_of(work.begin() + 1, work.end(), [&](const wire::Work& other) {
        return other.unit.block == unit.block && nodes.find(NodeId{2})->pending.contains(other.unit.id);
    }));
}

// What others manage is the node's fault: it gets no more work.
TEST_F(DispatcherTest, ANodeThatFailsWhatOthersManageIsQuarantined) {
    add_node(1, 3);
    begin(view(8, 16));
    deal(ViewId{8});
    for (const wire::Work& work : channel.all<wire::Work>())
        dispatcher.released(*nodes.find(NodeId{1}), failed(work.unit.id), now);
    add_node(2, 3);
    channel.sent.clear();
    deal(ViewId{8});
    EXPECT_TRUE(nodes.find(NodeId{1})->pending.empty()) << "three failures are unexplained";
    const auto work = channel.all<wire::Work>();
    ASSERT_EQ(work.size(), 3u);
    for (const wire::Work& message : work) {
        EXPECT_EQ(quarantine_reason(1), "");
        ASSERT_TRUE(admit(2, head(message.unit)));
        MergeReport merged = report(message.unit, FrameAssembler::Outcome::Merged, 2);
        const auto& tiles = dispatcher.find(ViewId{8})->tiles();
        merged.result.tile = static_cast<std::uint32_t>(
            std::find(tiles.begin(), tiles.end(), message.unit.tile) - tiles.begin());
        dispatcher.take(merged, now);
    }
    EXPECT_EQ(quarantine_reason(1), "it failed what another node rendered: device lost");
    EXPECT_EQ(dispatcher.prospects(view(8, 16), {Scene}).suitable, 1u);
    EXPECT_TRUE(dispatcher.release_from_quarantine("node-1", now));
    EXPECT_EQ(dispatcher.prospects(view(8, 16), {Scene}).suitable, 2u);
}

// Failures that were never dealt to it say nothing, about anything.
TEST_F(DispatcherTest, FailuresOfForeignUnitsAreIgnored) {
    add_node(1, 1);
    NodeRecord& liar = add_node(2, 0);
    begin(view(8, 8));
    deal(ViewId{8});
    for (std::uint64_t unit = 0; unit < 100; ++unit) dispatcher.released(liar, failed(UnitId{unit}), now);
    EXPECT_EQ(dispatcher.counts().refused, 0u);
    EXPECT_TRUE(dispatcher.find(ViewId{8})->failed_tiles().empty());
    EXPECT_TRUE(events.empty());
}

TEST_F(DispatcherTest, FilmThatWasNotAskedForIsRefusedAndItsSenderQuarantined) {
    add_node(1, 1);
    NodeRecord& liar = add_node(2, 0);
    begin(view(8, 8));
    begin(view(16, 8));
    deal(ViewId{8});
    const view::WorkUnit unit = channel.all<wire::Work>().at(0).unit;
    wire::FilmHead film = head(unit);
    EXPECT_FALSE(admit(2, film));
    film.view = ViewId{16};
    EXPECT_FALSE(admit(2, film)) << "a unit of another view";
    film = head(unit);
    film.revision = 7;
    EXPECT_FALSE(admit(2, film));
    EXPECT_EQ(dispatcher.refused_film(), 2u) << "film of an old revision is only late";
    EXPECT_EQ(quarantine_reason(2), "");
    film = head(unit);
    film.unit = UnitId{1u << 30};
    EXPECT_FALSE(admit(2, film));
    EXPECT_NE(quarantine_reason(2), "");
    dispatcher.send_film_taken();
    ASSERT_EQ(channel.all<wire::FilmTaken>().size(), 1u);
    EXPECT_EQ(channel.all<wire::FilmTaken>()[0].bytes, 4000u) << "dropped film leaves room, too";
    EXPECT_TRUE(admit(1, head(unit)));
    // Under another number it is the same node.
    dispatcher.node_gone(liar.id, Dispatcher::Departure::Silent, now);
    nodes.remove(NodeId{2});
    wire::Hello hello{.name = "node-2", .channels = {frame::Channel::Color}};
    NodeRecord& back = nodes.add(NodeId{3}, 3, 3, "node", std::move(hello), now);
    dispatcher.joined(back, now);
    EXPECT_TRUE(back.quarantined);
    dispatcher.collect_overdue(now + std::chrono::minutes(2));
    EXPECT_FALSE(back.quarantined);
}

TEST_F(DispatcherTest, DamagedFilmIsRenderedAgain) {
    add_node(1, 1);
    begin(view(8, 8));
    deal(ViewId{8});
    const view::WorkUnit unit = channel.all<wire::Work>().at(0).unit;
    ASSERT_TRUE(admit(1, head(unit)));
    MergeReport damaged = report(unit, FrameAssembler::Outcome::Misfit, 1);
    damaged.problem = "malformed message: a mean is not finite";
    EXPECT_EQ(dispatcher.take(damaged, now), Dispatcher::Taken::Dropped);
    EXPECT_EQ(dispatcher.counts().refused, 1u);
    EXPECT_FALSE(dispatcher.find(ViewId{8})->complete());
    add_node(2, 1);
    deal(ViewId{8});
    const view::WorkUnit again = channel.all<wire::Work>().back().unit;
    EXPECT_EQ(again.block, unit.block);
    // The master had no memory to merge it: it is rendered again, and no node is to blame.
    ASSERT_TRUE(admit(2, head(again)));
    MergeReport lost = report(again, FrameAssembler::Outcome::Misfit, 2);
    lost.failure = "std::bad_alloc";
    EXPECT_EQ(dispatcher.take(lost, now), Dispatcher::Taken::Dropped);
    EXPECT_EQ(quarantine_reason(2), "");
    EXPECT_EQ(dispatcher.counts().lost, 1u);
    EXPECT_FALSE(dispatcher.find(ViewId{8})->is_merging());
    add_node(3, 1);
    deal(ViewId{8});
    EXPECT_EQ(channel.all<wire::Work>().back().unit.block, unit.block);
    EXPECT_NE(channel.all<wire::Work>().back().unit.id, again.id);
}

TEST_F(DispatcherTest, ReproducibleWorkGoesToPinnedNodesOnly) {
    add_node(1, 1);
    add_node(2, 1).hello.reproducible = true;
    const view::View asked = view(8, 8);
    dispatcher.begin(asked, {.window = asked.window, .tile = 8, .spp = 4}, {Scene, true});
    EXPECT_EQ(dispatcher.prospects(asked, {Scene, true}).ready, 1u);
    EXPECT_EQ(dispatcher.prospects(asked, {Scene}).ready, 2u);
    deal(ViewId{8});
    EXPECT_TRUE(nodes.find(NodeId{1})->pending.empty());
    EXPECT_EQ(nodes.find(NodeId{2})->pending.size(), 1u);
}

TEST_F(DispatcherTest, AReproducibleFrameHasNodesOfOneKind) {
    const auto add = [&](std::uint64_t number, const std::string& kind) {
        NodeRecord& node = add_node(number, 1);
        node.hello.reproducible = true;
        node.hello.kind = kind;
    };
    add(1, "x");
    add(2, "y");
    add(3, "y");
    const view::View asked = view(8, 64);
    const NodeRequirements any{Scene, true};
    dispatcher.begin(asked, {.window = asked.window, .tile = 8, .spp = 4}, any);
    EXPECT_EQ(dispatcher.leading_kind(asked, Scene), "y") << "it has more workers";
    EXPECT_EQ(dispatcher.prospects(asked, any).ready, 2u) << "as many as may work together";
    deal(ViewId{8});
    EXPECT_EQ(dispatcher.kind(ViewId{8}), "y");
    EXPECT_TRUE(nodes.find(NodeId{1})->pending.empty());
    EXPECT_EQ(nodes.find(NodeId{2})->pending.size(), 1u);
    EXPECT_EQ(nodes.find(NodeId{3})->pending.size(), 1u);
    const std::string left_out = "node node-1 (kind x) takes no part: the frame is reproducible on kind y";
    EXPECT_EQ(dispatcher.left_out(ViewId{8}), std::vector{left_out});
    for (int i = 0; i < 3; ++i) dispatcher.collect_overdue(now);
    EXPECT_EQ(events, std::vector{left_out}) << "once";
    EXPECT_EQ(dispatcher.idle_reason(*nodes.find(NodeId{1})), "the frame is reproducible on kind y");
    EXPECT_EQ(dispatcher.idle_reason(*nodes.find(NodeId{2})), "");
    // The kind vanishes: the frame waits for it.
    for (const std::uint64_t gone : {2u, 3u}) {
        dispatcher.node_gone(NodeId{gone}, Dispatcher::Departure::Expected, now);
        nodes.remove(NodeId{gone});
    }
    deal(ViewId{8});
    EXPECT_TRUE(nodes.find(NodeId{1})->pending.empty());
    const NodeRequirements chosen{Scene, true, "y"};
    EXPECT_EQ(dispatcher.prospects(asked, chosen).suitable, 0u);
    EXPECT_NE(dispatcher.obstacles(asked, chosen).find("reproducible on kind y"), std::string::npos);
    add(4, "y");
    deal(ViewId{8});
    EXPECT_EQ(nodes.find(NodeId{4})->pending.size(), 1u);
}

TEST_F(DispatcherTest, NullNodesRenderOnlyAmongThemselves) {
    const auto add = [&](std::uint64_t number, const std::string& kind) {
        wire::Hello hello{.name = "node-" + std::to_string(number), .channels = {frame::Channel::Color}};
        hello.kind = kind;
        NodeRecord& node = nodes.add(NodeId{number}, number, number, "node", std::move(hello), now);
        node.bulk = 100 + number;
        node.reported = node.state.version = Scene;
        node.state.free_slots = 1;
    };
    add(1, "null-1/r1");
    const view::View asked = view(8, 64);
    begin(asked);
    deal(ViewId{8});
    ASSERT_EQ(nodes.find(NodeId{1})->pending.size(), 1u) << "there are no others";
    const view::WorkUnit unit = channel.all<wire::Work>().at(0).unit;
    dispatcher.take(report(unit, FrameAssembler::Outcome::Merged, 1), now);
    EXPECT_FALSE(dispatcher.is_superseded(ViewId{8}));
    add(2, "embree-3/r1");
    EXPECT_TRUE(dispatcher.is_superseded(ViewId{8})) << "its film has test patterns";
    EXPECT_EQ(dispatcher.prospects(asked, {Scene}).ready, 1u);
    for (int i = 0; i < 3; ++i) dispatcher.collect_overdue(now);
    ASSERT_EQ(events.size(), 1u) << "once";
    EXPECT_NE(events[0].find("node node-1 (kind null-1/r1) takes no part: the null back-end"),
              std::string::npos);
    EXPECT_NE(dispatcher.idle_reason(*nodes.find(NodeId{1})), "");
    begin(asked);
    nodes.find(NodeId{1})->pending.clear();
    deal(ViewId{8});
    EXPECT_TRUE(nodes.find(NodeId{1})->pending.empty());
    ASSERT_EQ(nodes.find(NodeId{2})->pending.size(), 1u);
    dispatcher.take(report(channel.all<wire::Work>().back().unit, FrameAssembler::Outcome::Merged, 2), now);
    // A picture that others began waits for others.
    dispatcher.node_gone(NodeId{2}, Dispatcher::Departure::Expected, now);
    nodes.remove(NodeId{2});
    deal(ViewId{8});
    EXPECT_TRUE(nodes.find(NodeId{1})->pending.empty());
    EXPECT_NE(dispatcher.obstacles(asked, {Scene}).find("1 null nodes idle"), std::string::npos);
    EXPECT_EQ(dispatcher.prospects(view(16, 64), {Scene}).ready, 1u) << "another may be of test patterns";
}

TEST_F(DispatcherTest, ANodeMayCompileBeforeItsFirstFilmAndALongUnitMayTakeLong) {
    NodeRecord& node = add_node(1, 1);
    begin(view(8, 16));
    dispatcher.collect_overdue(now);
    EXPECT_EQ(node.allowance, Duration::zero()) << "it has no units";
    deal(ViewId{8});
    dispatcher.collect_overdue(now);
    EXPECT_EQ(node.allowance, StuckSettings{}.first_film);
    const view::WorkUnit unit = channel.all<wire::Work>().at(0).unit;
    MergeReport slow = report(unit, FrameAssembler::Outcome::Merged, 1);
    slow.pixel_samples = 1;
    slow.busy = std::chrono::seconds(60);
    dispatcher.take(slow, now);
    node.pending.clear();
    deal(ViewId{8});
    ASSERT_FALSE(dispatcher.find(ViewId{8})->held_by(NodeId{1}).empty());
    dispatcher.collect_overdue(now);
    EXPECT_GE(node.allowance, std::chrono::minutes(10)) << "ten times what a sample takes";
    node.stuck = true;
    for (int i = 0; i < 2; ++i) dispatcher.collect_overdue(now + std::chrono::minutes(11));
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].find("node node-1 is stuck: it has finished nothing for 66"), 0u) << events[0];
}

}  // namespace
}  // namespace tessera::master
