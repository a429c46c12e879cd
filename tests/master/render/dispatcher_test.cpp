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
    Dispatcher dispatcher{std::chrono::seconds(5), clock, nodes, outbox,
                          [this](const Event& event) { events.push_back(event.text); }};

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
    MergeReport report(const view::WorkUnit& unit, FrameAssembler::Outcome outcome, net::PeerId peer) const {
        MergeReport report{.peer = peer, .unit = unit.id, .view = unit.view, .revision = unit.revision};
        report.block = unit.block;
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
    EXPECT_EQ(dispatcher.take(report(unit, FrameAssembler::Outcome::Merged, 101), now),
              Dispatcher::Taken::New);
    EXPECT_EQ(dispatcher.take(report(unit, FrameAssembler::Outcome::Conflict, 102), now),
              Dispatcher::Taken::Known);
    ASSERT_EQ(events.size(), 1u);
    EXPECT_NE(events[0].find("second: node-2"), std::string::npos) << events[0];
    EXPECT_NE(events[0].find("tessera probe SCENE --pixel 0,0 --sample 0"), std::string::npos) << events[0];
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

TEST_F(DispatcherTest, FailedUnitNamesItsPass) {
    NodeRecord& node = add_node(1, 1);
    begin(view(8, 8));
    begin(view(16, 8));
    deal(ViewId{16});
    const view::WorkUnit unit = channel.all<wire::Work>().at(0).unit;
    const auto failure = dispatcher.released(
        node, {.unit = unit.id, .reason = wire::ReleaseReason::Failed, .message = "no memory"}, now);
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->pass, ViewId{16});
    EXPECT_EQ(failure->message, "no memory");
    EXPECT_EQ(dispatcher.counts().refused, 1u);
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

}  // namespace
}  // namespace tessera::master
