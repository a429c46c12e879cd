// Nodes that lie, fail, or send damaged film: they cost nothing but themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>

#include "mediator/frame/render_revision.h"
#include "mediator/frame/resolve.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/hooked_backend.h"
#include "tests/cluster/raw_peer.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

struct FaultyNodes : testing::Test {
    static session::ViewRequest small_request() {
        session::ViewRequest request{.stop = {.spp = 16}, .wait_limit = 60s, .film = true};
        request.view.width = 96;
        request.view.height = 64;
        request.view.window = {0, 0, 96, 64};
        request.view.camera = view::perspective(glm::dmat4(1.0), 0.8, 1.5);
        request.view.channels = {frame::Channel::Radiance, frame::Channel::Albedo, frame::Channel::Depth};
        return request;
    }
    client::ViewResult render(const session::ViewRequest& request = small_request()) {
        auto blobs = std::make_shared<scene::BlobStore>();
        const auto session = cluster.batch(blobs);
        client::ViewResult result = client::render(*session, request, {}, {});
        status = session->status();
        return result;
    }
    static std::string honest_hash() {
        LoopbackCluster honest;
        honest.add_node("null");
        auto blobs = std::make_shared<scene::BlobStore>();
        const auto session = honest.batch(blobs);
        return to_hex(frame::film_hash(*client::render(*session, small_request(), {}, {}).film()));
    }
    bool was_logged(const std::string& text) const {
        const std::vector<std::string> events = cluster.events();
        return std::ranges::any_of(
            events, [&](const std::string& event) { return event.find(text) != std::string::npos; });
    }
    std::string quarantine(const std::string& name) const {
        for (const session::NodeStatus& node : status.nodes) {
            if (node.summary.name == name) return node.quarantine;
        }
        return "no such node";
    }
    // Every unit is answered for exactly once.
    void expect_balanced() const {
        const session::UnitCounts& units = status.units;
        EXPECT_EQ(units.issued + units.reissued,
                  units.merged + units.duplicate + units.cancelled + units.refused + units.lost);
    }

    LoopbackCluster cluster;
    session::ClusterStatus status;
};

TEST_F(FaultyNodes, FilmThatWasNeverAskedForChangesNoPicture) {
    cluster.add_node(hooked([](const auto&, auto&) {}, 5us));
    std::atomic<bool> done = false;
    std::jthread forger([&] {
        RawPeer peer(cluster.channel(net::Role::Node));
        wire::Hello hello{.peer = wire::PeerKind::Node, .name = "forger"};
        hello.channels = small_request().view.channels;
        hello.renderers = view::TracingRenderers;
        hello.kind = "null";
        hello.concurrent_units = 1;
        peer.send(hello);
        if (!peer.wait_for<wire::Welcome>()) return;
        peer.send(wire::BulkHello{peer.received<wire::Welcome>()->token});
        while (!done) {
            for (std::uint64_t id = 1; id <= 64; ++id) {
                wire::FilmPart film{.unit = UnitId{id}, .view = ViewId{id}, .revision = 1, .version = {}};
                film.film = frame::FilmTile({0, 0, 32, 32}, {0, 5}, small_request().view.channels);
                std::ranges::fill(film.film.planes, 1000.0f);
                peer.send(wire::BulkMessage(std::move(film)));
            }
            peer.poll();
        }
    });
    std::this_thread::sleep_for(50ms);
    const client::ViewResult result = render();
    done = true;
    EXPECT_NE(quarantine("forger").find("it sent film"), std::string::npos) << quarantine("forger");
    EXPECT_GE(status.refused_film, 3u);
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    EXPECT_EQ(to_hex(frame::film_hash(*result.film())), honest_hash());
    expect_balanced();
}

// It takes all units that it gets, says that it renders them and others, and sends nothing.
TEST_F(FaultyNodes, ANodeThatLiesAboutItsCapacityAndProgressCostsNoPicture) {
    cluster.add_node(hooked([](const auto&, auto&) {}, 20us));
    const auto session = cluster.batch(std::make_shared<scene::BlobStore>());
    session->refresh();
    const Version version = session->scene().version();
    const Hash128 hash = session->scene().state_hash();
    std::atomic<bool> done = false;
    std::atomic<std::uint64_t> units = 0;
    std::jthread liar([&] {
        RawPeer peer(cluster.channel(net::Role::Node));
        wire::Hello hello{.peer = wire::PeerKind::Node, .name = "liar"};
        hello.channels = small_request().view.channels;
        hello.renderers = view::TracingRenderers;
        hello.kind = "null";
        hello.concurrent_units = 1u << 31;
        peer.send(hello);
        for (int i = 0; i < 20; ++i) peer.poll();
        EXPECT_EQ(peer.received<wire::Welcome>(), nullptr) << "no machine has so many cores";
        hello.concurrent_units = wire::MaxConcurrentUnits;
        peer.send(hello);
        if (!peer.wait_for<wire::Welcome>()) return;
        peer.send(wire::BulkHello{peer.received<wire::Welcome>()->token});
        wire::Heartbeat& lie = peer.heartbeat;
        lie.phase = session::NodePhase::Rendering;
        lie.progress = std::numeric_limits<std::uint64_t>::max();
        lie.free_slots = std::numeric_limits<std::uint32_t>::max();
        for (std::uint64_t id = 0; id < 64; ++id) lie.in_flight.push_back(UnitId{(id << 32) + 1 + id});
        lie.version = version;
        peer.send(wire::VersionReport{.version = version, .state_hash = hash});
        while (!done) {
            peer.poll();
            while (const auto* work = peer.received<wire::Work>(units)) {
                lie.in_flight.push_back(work->unit.id);
                lie.last_work_sequence = work->sequence + 1'000'000;
                ++units;
            }
            lie.progress -= 1000;
        }
    });
    session::ViewRequest request = small_request();
    request.min_nodes = 2;
    const client::ViewResult result = client::render(*session, request, {}, {});
    status = session->status();
    done = true;
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    EXPECT_EQ(to_hex(frame::film_hash(*result.film())), honest_hash());
    EXPECT_GT(units, 0u) << "it was believed";
    EXPECT_LE(units, 2u * wire::MaxConcurrentUnits);
    EXPECT_EQ(quarantine("node-1"), "");
    expect_balanced();
}

TEST_F(FaultyNodes, ANodeThatFailsEveryUnitIsQuarantinedAndTheJobFinishes) {
    std::atomic<int> failures = 0;
    cluster.add_node(hooked([&](const auto&, auto&) {
        ++failures;
        throw Error(ErrorCode::Unavailable, "the device is lost");
    }));
    for (int i = 0; i < 2; ++i) cluster.add_node(hooked([](const auto&, auto&) {}, 2us));
    session::ViewRequest request = small_request();
    request.min_nodes = 3;
    const client::ViewResult result = render(request);
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    EXPECT_EQ(to_hex(frame::film_hash(*result.film())), honest_hash());
    EXPECT_GT(failures, 0);
    EXPECT_LE(failures, 12) << "it gets no more work";
    EXPECT_NE(quarantine("node-1").find("the device is lost"), std::string::npos) << quarantine("node-1");
    EXPECT_TRUE(was_logged("tessera node release node-1"));
    expect_balanced();
}

TEST_F(FaultyNodes, FilmThatIsNotFiniteIsRefusedAndRenderedElsewhere) {
    for (const float poison :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        cluster.add_node(hooked([poison](const auto&, backend::RenderResult& result) {
            for (frame::FilmTile& block : result.blocks) block.planes[block.pixel_count()] = poison;
        }));
    }
    cluster.add_node("null");
    const client::ViewResult result = render();
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    EXPECT_EQ(to_hex(frame::film_hash(*result.film())), honest_hash());
    expect_balanced();
}

TEST_F(FaultyNodes, ATileThatNoNodeCanRenderIsLeftOutAndNamed) {
    for (int i = 0; i < 3; ++i) {
        cluster.add_node(hooked([](const view::WorkUnit& unit, auto&) {
            if (unit.tile.x == 0 && unit.tile.y == 0) throw Error(ErrorCode::Internal, "a bad shader");
        }));
    }
    const client::ViewResult result = render();
    EXPECT_EQ(result.summary.outcome, session::Outcome::Incomplete);
    ASSERT_EQ(result.summary.failed_tiles.size(), 1u);
    const session::FailedTile& failed = result.summary.failed_tiles[0];
    EXPECT_EQ(failed.rect.x, 0);
    EXPECT_EQ(failed.rect.y, 0);
    EXPECT_NE(result.summary.message.find("a bad shader"), std::string::npos) << result.summary.message;
    for (int i = 1; i <= 3; ++i)
        EXPECT_EQ(quarantine("node-" + std::to_string(i)), "") << "the samples are to blame, not the nodes";
    expect_balanced();
}

// The text of an error becomes part of the log, of the status and of the summary, each a message of its own.
TEST_F(FaultyNodes, ErrorsOfAnyLengthReachTheClientShortened) {
    for (int i = 0; i < 3; ++i) {
        cluster.add_node(hooked([](const view::WorkUnit& unit, auto&) {
            if (unit.tile.x == 0 && unit.tile.y == 0)
                throw Error(ErrorCode::Internal, "a bad shader" + std::string(100'000, '!'));
        }));
    }
    const client::ViewResult result = render();
    EXPECT_EQ(result.summary.outcome, session::Outcome::Incomplete);
    EXPECT_EQ(result.summary.failed_tiles.size(), 1u);
    EXPECT_NE(result.summary.message.find("a bad shader"), std::string::npos);
    EXPECT_LT(result.summary.message.size(), 2'000u);
    expect_balanced();
}

// Nodes of another kind have other bits: here all of them do.
TEST_F(FaultyNodes, AReproducibleFrameIsRenderedByOneKindAlone) {
    std::atomic<int> others = 0;
    cluster.add_node(hooked(
        [&](const auto&, backend::RenderResult& result) {
            ++others;
            for (frame::FilmTile& block : result.blocks) std::ranges::fill(block.planes, 0.5f);
        },
        5us, "other-1"));
    for (int i = 0; i < 2; ++i) cluster.add_node(hooked([](const auto&, auto&) {}, 5us, "mine-1"));
    session::ViewRequest request = small_request();
    request.reproducible = true;
    request.min_nodes = 2;
    request.picture = session::PictureEncoding::Png;
    const client::ViewResult result = render(request);
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    EXPECT_EQ(to_hex(frame::film_hash(*result.film())), honest_hash());
    EXPECT_EQ(others, 0);
    const std::string left_out =
        "node node-1 (kind other-1) takes no part: the frame is reproducible on kind mine-1";
    EXPECT_TRUE(was_logged(left_out));
    EXPECT_TRUE(std::ranges::find(result.summary.picture.notes, left_out) !=
                result.summary.picture.notes.end());
    request.min_nodes = 3;
    request.wait_limit = 200ms;
    const client::ViewResult waiting = render(request);
    EXPECT_EQ(waiting.summary.outcome, session::Outcome::NoNodes) << "no kind has three nodes";
    EXPECT_NE(waiting.summary.message.find("there are 2 kinds"), std::string::npos)
        << waiting.summary.message;
    expect_balanced();
}

void quick_to_be_stuck(master::MasterSettings& settings) {
    settings.stuck = {.allowance = 500ms, .first_film = 60s};
}

// As a driver that compiles kernels for half a minute.
TEST_F(FaultyNodes, ANodeThatCompilesBeforeItsFirstUnitIsNotStuck) {
    LoopbackCluster patient(quick_to_be_stuck);
    std::atomic<bool> is_first = true;
    patient.add_node(hooked([&](const auto&, auto&) {
        if (is_first.exchange(false)) std::this_thread::sleep_for(1500ms);
    }));
    const auto session = patient.batch(std::make_shared<scene::BlobStore>());
    const client::ViewResult result = client::render(*session, small_request(), {}, {});
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    EXPECT_EQ(result.summary.units.lost, 0u);
    EXPECT_EQ(result.summary.units.reissued, 0u);
    for (const std::string& event : patient.events())
        EXPECT_EQ(event.find("is stuck"), std::string::npos) << event;
}

TEST_F(FaultyNodes, ANodeThatStopsInTheMiddleIsStuckAndOthersGetItsUnits) {
    LoopbackCluster strict(quick_to_be_stuck);
    std::atomic<int> units = 0;
    std::atomic<bool> go_on = false;
    strict.add_node(hooked([&](const auto&, auto&) {
        if (++units < 5) return;
        while (!go_on) std::this_thread::sleep_for(5ms);
    }));
    session::ViewRequest request = small_request();
    const auto session = strict.batch(std::make_shared<scene::BlobStore>());
    std::jthread late([&] {
        const auto says_stuck = [&] {
            return std::ranges::any_of(strict.events(), [](const std::string& event) {
                return event.find("node node-1 is stuck") != std::string::npos;
            });
        };
        for (int i = 0; i < 2000 && !says_stuck(); ++i) std::this_thread::sleep_for(5ms);
        EXPECT_TRUE(says_stuck());
        strict.add_node("null");
    });
    const client::ViewResult result = client::render(*session, request, {}, {});
    go_on = true;
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    EXPECT_GT(result.summary.units.lost, 0u);
    EXPECT_EQ(to_hex(frame::film_hash(*result.film())), honest_hash());
}

void verify_all(master::MasterSettings& settings) {
    settings.verified_share = 1.0;
}

session::ViewRequest larger_request(std::uint32_t nodes) {
    session::ViewRequest request = FaultyNodes::small_request();
    request.view.width = 256;
    request.view.height = 192;
    request.view.window = {0, 0, 256, 192};
    request.min_nodes = nodes;
    return request;
}

TEST_F(FaultyNodes, VerifiedFilmIsThatOfHonestNodesAndIsMergedOnce) {
    std::string hashes[2];
    for (const bool verified : {false, true}) {
        LoopbackCluster pair(verified ? verify_all : [](master::MasterSettings&) {});
        for (int i = 0; i < 2; ++i) pair.add_node("null", {}, 2us);
        const auto session = pair.batch(std::make_shared<scene::BlobStore>());
        const client::ViewResult result = client::render(*session, larger_request(2), {}, {});
        EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
        hashes[verified] = to_hex(frame::film_hash(*result.film()));
        EXPECT_EQ(result.summary.samples, 256u * 192u * 16u);
        status = session->status();
        EXPECT_EQ(status.verified_units > 0, verified) << status.verified_units;
        EXPECT_EQ(status.contradictions, 0u);
        expect_balanced();
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_F(FaultyNodes, ANodeThatLiesIsFoundByTheOthersAndQuarantined) {
    LoopbackCluster trio(verify_all);
    trio.add_node(hooked(
        [](const auto&, backend::RenderResult& result) {
            for (frame::FilmTile& block : result.blocks) {
                std::uint32_t bits = std::bit_cast<std::uint32_t>(block.planes[0]);
                block.planes[0] = std::bit_cast<float>(bits ^ 1u);
            }
        },
        2us));
    for (int i = 0; i < 2; ++i) trio.add_node(hooked([](const auto&, auto&) {}, 2us));
    const auto session = trio.batch(std::make_shared<scene::BlobStore>());
    const client::ViewResult result = client::render(*session, larger_request(3), {}, {});
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    status = session->status();
    EXPECT_GT(status.contradictions, 0u);
    EXPECT_NE(quarantine("node-1").find("differs from that of two other nodes (unit "), std::string::npos)
        << quarantine("node-1");
    EXPECT_EQ(quarantine("node-2"), "");
    EXPECT_EQ(quarantine("node-3"), "");
    const std::vector<std::string> events = trio.events();
    EXPECT_TRUE(std::ranges::any_of(events, [](const std::string& event) {
        return event.find("node-1") != std::string::npos &&
               event.find("gave different bits for unit") != std::string::npos &&
               event.find("samples 0..") != std::string::npos;
    }));
    expect_balanced();
}

// Its test patterns do not get into pictures, whichever node comes first.
TEST_F(FaultyNodes, ANullNodeRendersNothingWhileOthersAreConnected) {
    std::atomic<int> patterns = 0;
    cluster.add_node(hooked([&](const auto&, auto&) { ++patterns; }, 100us));
    std::jthread late([&] {
        while (patterns == 0) std::this_thread::sleep_for(1ms);
        cluster.add_node(hooked(
            [](const auto&, backend::RenderResult& result) {
                for (frame::FilmTile& block : result.blocks) std::ranges::fill(block.planes, 0.5f);
            },
            {}, "real-1"));
    });
    session::ViewRequest request = small_request();
    request.picture = session::PictureEncoding::Png;
    const client::ViewResult result = render(request);
    late.join();
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete) << result.summary.message;
    EXPECT_TRUE(std::ranges::all_of(result.film()->plane(0), [](float value) { return value == 0.5f; }));
    ASSERT_EQ(result.summary.nodes.size(), 1u);
    EXPECT_EQ(result.summary.nodes[0].name, "node-2");
    EXPECT_TRUE(was_logged("node node-1 (kind " + frame::with_render_revision("null-1") +
                           ") takes no part: the null back-end"));
    ASSERT_FALSE(result.summary.picture.notes.empty());
    EXPECT_NE(result.summary.picture.notes[0].find("node node-1"), std::string::npos);
    EXPECT_NE(status.nodes.at(0).idle_reason, "");
}

}  // namespace
}  // namespace tessera::test
