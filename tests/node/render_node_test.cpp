// The node as a whole, with the null back-end, against a scripted master in the same process.
#include "node/render_node.h"

#include <gtest/gtest.h>

#include <thread>

#include "mediator/backend/catalog.h"
#include "tests/contract/contract_scene.h"
#include "tests/node/scripted_master.h"

namespace tessera::node {
namespace {

using namespace std::chrono_literals;
using session::NodePhase;
using wire::ReleaseReason;

// The null back-end with edits of a given duration.
class SlowBackend final : public backend::Backend {
  public:
    SlowBackend(std::unique_ptr<backend::Backend> inner, Duration edit_time)
        : inner_(std::move(inner)), edit_time_(edit_time) {}
    backend::Capabilities capabilities() const override { return inner_->capabilities(); }
    Version version() const override { return inner_->version(); }
    std::unique_ptr<backend::EditScope> begin_edit() override {
        std::this_thread::sleep_for(edit_time_);
        return inner_->begin_edit();
    }
    backend::RenderResult render(const view::View& view, const view::WorkUnit& unit,
                                 std::stop_token stop) override {
        return inner_->render(view, unit, stop);
    }
    std::vector<std::string> probe(const view::View& view, std::uint32_t x, std::uint32_t y,
                                   std::uint64_t sample) override {
        return inner_->probe(view, x, y, sample);
    }

  private:
    std::unique_ptr<backend::Backend> inner_;
    Duration edit_time_;
};

struct RenderNodeTest : testing::Test {
    ~RenderNodeTest() override { at_once.request_stop(); }

    std::unique_ptr<backend::Backend> null_backend(Duration cost = 0ns) const {
        return backend::find_backend("null").make(
            {.threads = 2, .isa = {}, .simulated_sample_cost = cost, .blobs = blobs});
    }

    NodeSettings settings;
    void start(std::unique_ptr<backend::Backend> with) {
        settings.workers = 2;
        settings.liveness.interval = 50ms;
        settings.liveness.missed = 40;
        node.emplace(hub.client(net::Role::Node), std::move(with), blobs, clock, settings, NodeCallbacks{});
        thread = std::jthread([this] { result = node->run(drain.get_token(), at_once.get_token()); });
    }

    // Welcomed, the contract scene built, the view open.
    void start_synced(std::unique_ptr<backend::Backend> with) {
        start(std::move(with));
        master.welcome();
        master.send(wire::Changes{builder.edit(test::contract_scene(master.blobs))});
        EXPECT_EQ(master.expect<wire::VersionReport>().state_hash, builder.scene().state_hash());
        view = test::contract_view({frame::Channel::Radiance});
        master.send(wire::OpenView{view});
    }

    void work(std::uint64_t id, frame::SampleBlock block = {0, 2}) {
        master.send(wire::Work{++sequence, unit(id, block)});
    }
    view::WorkUnit unit(std::uint64_t id, frame::SampleBlock block = {0, 2}) const {
        return {.id = UnitId{id},
                .view = view.id,
                .revision = view.revision,
                .version = builder.scene().version(),
                .tile = {0, 0, 16, 16},
                .block = block};
    }

    SteadyClock clock;
    net::LoopbackHub hub;
    test::ScriptedMaster master{hub};
    test::SceneBuilder builder;
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();  // the node's own
    view::View view;
    std::uint64_t sequence = 0;
    std::stop_source drain, at_once;
    NodeResult result;
    std::optional<RenderNode> node;
    std::jthread thread;  // ends before everything it uses
};

TEST_F(RenderNodeTest, FetchesBuildsRendersAndSendsTheSameBitsAsTheBackEndAlone) {
    start_synced(null_backend());
    EXPECT_EQ(master.expect_bulk<wire::BulkHello>().token, 101u);
    for (std::uint64_t id = 1; id <= 3; ++id) work(id, {(id - 1) * 4, 2});

    const auto alone = null_backend();
    test::commit(*alone, {snapshot(builder.scene())});
    std::set<UnitId> seen;
    while (seen.size() < 3) {
        const auto part = master.expect_bulk<wire::FilmPart>();
        seen.insert(part.unit);
        const backend::RenderResult expected =
            alone->render(view, unit(part.unit.value, part.film.block), {});
        EXPECT_TRUE(frame::identical_bits(part.film, expected.blocks.at(0)));
        EXPECT_EQ(part.rays, 4u * 256u);
    }
    const wire::Heartbeat beat = master.expect_heartbeat(
        [](const auto& b) { return b.in_flight.empty() && b.last_work_sequence == 3; });
    EXPECT_EQ(beat.progress, 3u * 4u * 256u);
    EXPECT_EQ(beat.free_slots, 4u);
}

TEST_F(RenderNodeTest, HeartbeatsContinueWhileItBuilds) {
    start(std::make_unique<SlowBackend>(null_backend(), 600ms));
    master.welcome();
    master.send(wire::Changes{builder.edit(test::contract_scene(master.blobs))});
    master.expect_heartbeat([](const auto& beat) { return beat.phase == NodePhase::Building; });
    int building = 0;
    while (master.expect<wire::Heartbeat>().phase == NodePhase::Building) ++building;
    EXPECT_GE(building, 3);
}

TEST_F(RenderNodeTest, BadGeometryFromTheNetworkIsReported) {
    start(null_backend());
    master.welcome();
    auto entries = test::contract_scene(master.blobs);
    auto& geometry = std::get<scene::Geometry>(std::get<scene::Create>(entries[5]).object);
    geometry.indices = test::array_blob<std::uint32_t>(master.blobs, {0, 1, 4'000'000'000u});
    master.send(wire::Changes{builder.edit(std::move(entries))});
    EXPECT_FALSE(master.expect<wire::VersionReport>().problems.empty());
}

TEST_F(RenderNodeTest, ADelayedBlobIsWaitedFor) {
    start(null_backend());
    master.welcome();
    scene::BlobStore elsewhere;
    master.send(wire::Changes{builder.edit(test::contract_scene(elsewhere))});
    master.expect_heartbeat(
        [](const auto& beat) { return beat.phase == NodePhase::Syncing && beat.free_slots == 4; });
    test::contract_scene(master.blobs);
    EXPECT_EQ(master.expect<wire::VersionReport>().version, builder.scene().version());
}

TEST_F(RenderNodeTest, CancellingALongUnitFreesItsSlot) {
    start_synced(null_backend(1us));
    work(1, {0, 20});
    master.expect_heartbeat([](const auto& beat) { return beat.in_flight.size() == 1; });
    std::this_thread::sleep_for(20ms);
    master.send(wire::CancelUnits{{UnitId{1}}});
    EXPECT_EQ(master.expect<wire::UnitReleased>().reason, ReleaseReason::Cancelled);
    master.expect_heartbeat([](const auto& beat) { return beat.free_slots == 4; });
}

TEST_F(RenderNodeTest, HandsBackWhatIsRenderedSoFar) {
    start_synced(null_backend(100us));
    work(1, {0, 20});
    master.expect_heartbeat([](const auto& beat) { return beat.in_flight.size() == 1; });
    std::this_thread::sleep_for(20ms);
    drain.request_stop();
    EXPECT_EQ(master.expect<wire::UnitReleased>().reason, ReleaseReason::Leaving);
    (void)master.expect<wire::Goodbye>();
    thread.join();
    EXPECT_EQ(result.counters.units_done, 0u);
    EXPECT_EQ(result.failure, "");
}

TEST_F(RenderNodeTest, DrainsAndReportsTheUnitsSent) {
    settings.drain = Drain::Finish;
    start_synced(null_backend(20us));
    for (std::uint64_t id = 1; id <= 4; ++id) work(id, {0, 4});
    master.expect_heartbeat([](const auto& beat) { return beat.last_work_sequence == 4; });
    drain.request_stop();
    const wire::Goodbye goodbye = master.expect<wire::Goodbye>();
    std::set<UnitId> sent;
    for (std::size_t i = 0; i < goodbye.units_sent.size(); ++i)
        sent.insert(master.expect_bulk<wire::FilmPart>().unit);
    EXPECT_EQ(std::vector<UnitId>(sent.begin(), sent.end()),
              goodbye.units_sent.size() == 2 && goodbye.units_sent[0] > goodbye.units_sent[1]
                  ? std::vector<UnitId>(goodbye.units_sent.rbegin(), goodbye.units_sent.rend())
                  : goodbye.units_sent);
    EXPECT_EQ(sent.size(), 2u);
    thread.join();
    EXPECT_EQ(result.failure, "");
    EXPECT_EQ(result.counters.units_released, 2u);
}

TEST_F(RenderNodeTest, LeavingAtOnceFinishesNoUnits) {
    start_synced(null_backend(100us));
    work(1, {0, 20});
    master.expect_heartbeat([](const auto& beat) { return beat.in_flight.size() == 1; });
    at_once.request_stop();
    EXPECT_TRUE(master.expect<wire::Goodbye>().units_sent.empty());
    thread.join();
}

TEST_F(RenderNodeTest, MalformedMessagesAreDroppedAndCounted) {
    start_synced(null_backend());
    for (std::size_t size : {0u, 1u, 7u, 300u}) {
        master.send_raw(net::Link::Control, net::Bytes(size, std::byte{0xa5}));
        master.send_raw(net::Link::Bulk, net::Bytes(size, std::byte{0xa5}));
    }
    work(1);
    EXPECT_EQ(master.expect_bulk<wire::FilmPart>().unit, UnitId{1});
    drain.request_stop();
    thread.join();
    EXPECT_GE(result.counters.malformed_messages, 6u);  // an empty message may mean an empty one of some kind
}

TEST_F(RenderNodeTest, ARefusalEndsTheRunWithItsReason) {
    start(null_backend());
    master.expect<wire::Hello>();
    master.send(wire::Refusal{"not here"});
    thread.join();
    EXPECT_NE(result.failure.find("not here"), std::string::npos);
}

TEST_F(RenderNodeTest, ATimeoutOfTheMasterIsFollowedByAnotherHello) {
    NodeSettings settings;
    settings.liveness.interval = 20ms;
    settings.liveness.min_backoff = 10ms;
    std::atomic<int> reconnects = 0;
    node.emplace(hub.client(net::Role::Node), null_backend(), blobs, clock, settings,
                 NodeCallbacks{.event = {}, .reconnect = [&] { ++reconnects; }});
    thread = std::jthread([this] { result = node->run(drain.get_token(), at_once.get_token()); });
    master.heartbeats = false;
    EXPECT_EQ(master.expect<wire::Hello>().resume_token, 0u);
    EXPECT_EQ(master.expect<wire::Hello>().resume_token, 0u);
    master.send(wire::Welcome{
        .peer_number = 3, .token = 33, .epoch = 1, .heartbeat_interval = 20ms, .missed_heartbeats = 3});
    EXPECT_EQ(master.expect<wire::Hello>().resume_token, 33u);
    EXPECT_GE(reconnects, 1);
    at_once.request_stop();
    thread.join();
}

}  // namespace
}  // namespace tessera::node
