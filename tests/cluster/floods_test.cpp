// Peers that send more than they should, and a loop that was away: others notice nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "mediator/scene/fields.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"
#include "tests/cluster/raw_peer.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

struct Floods : testing::Test {
    LoopbackCluster cluster;
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    std::unique_ptr<client::Session> ann = cluster.member("ann", blobs);
    ObjectId first;

    void SetUp() override {
        first = ann->new_id();
        for (int i = 0; i < 3; ++i) (void)ann->new_id();
        ASSERT_TRUE(ann->submit(scene_entries(first, *blobs)).accepted);
    }
    void paint(float red) {
        const scene::Material material{.base_color = {red, 0, 0, 1}};
        const auto result = ann->submit(
            {scene::Update{ObjectId{first.value + 1},
                           scene::Fields<scene::Material>(&scene::Material::base_color).bits(), material}});
        ASSERT_TRUE(result.accepted) << result.problems.at(0);
    }
    std::size_t events_with(const std::string& part) const {
        const auto events = cluster.events();
        return static_cast<std::size_t>(std::ranges::count_if(
            events, [&](const std::string& text) { return text.find(part) != std::string::npos; }));
    }
    RawPeer join_as_viewer() {
        RawPeer peer(cluster.channel(net::Role::Viewer, "eve"));
        EXPECT_TRUE(peer.connect("eve"));
        peer.send(wire::JoinScene{.title = "test", .name = "eve"});
        EXPECT_TRUE(peer.wait_for<wire::SceneJoined>());
        return peer;
    }
};

TEST_F(Floods, AViewerThatReadsAndAsksWithoutEndDelaysNoOther) {
    cluster.add_node("null");
    RawPeer eve = join_as_viewer();
    for (int round = 0; round < 20; ++round) {
        for (std::uint64_t i = 0; i < 200; ++i) {
            const std::uint64_t request = 1000u * static_cast<std::uint64_t>(round) + i + 1;
            eve.send(wire::ReadScene{.request = request});
            eve.send(wire::StatusRequest{});
            eve.send(wire::ReadMembers{.request = request});
            eve.send(wire::SubmitEdit{});
            eve.send(wire::BulkMessage(wire::BlobRequest{Hash256{}, 0}));
        }
        paint(0.05f * float(round));
    }
    const session::ClusterStatus status = ann->status();
    EXPECT_GE(status.dropped_messages, 4000u) << "edits of a viewer";
    EXPECT_EQ(status.nodes.size(), 1u);
    EXPECT_EQ(status.caught_exceptions, 0u);
    EXPECT_LT(status.loop.longest_cpu_seconds, 0.02) << status.loop.longest_part;
    EXPECT_EQ(events_with("is gone"), 0u);
    EXPECT_LT(events_with("was dropped"), 500u) << "the log is limited in rate";
}

TEST_F(Floods, AClientReadsTheSceneOnceAtATime) {
    RawPeer eve = join_as_viewer();
    paint(0.5f);
    for (std::uint64_t i = 1; i <= 50; ++i) eve.send(wire::ReadScene{.request = i});
    ASSERT_TRUE(eve.wait_for<wire::SceneContent>());
    for (int i = 0; i < 20; ++i) eve.poll();
    std::size_t answers = 0, refusals = 0;
    while (eve.received<wire::SceneContent>(answers) != nullptr) ++answers;
    while (eve.received<wire::RequestDone>(refusals) != nullptr) ++refusals;
    EXPECT_EQ(answers + refusals, 50u) << "each gets an answer";
}

TEST_F(Floods, AStallOfTheLoopRemovesNoPeer) {
    cluster.add_node("null");
    const auto bob = cluster.member("bob", std::make_shared<scene::BlobStore>());
    for (int i = 0; i < 200 && ann->status().nodes.empty(); ++i) std::this_thread::sleep_for(10ms);
    cluster.stall(2500ms);  // peers time out after 1 s
    paint(0.5f);
    EXPECT_EQ(ann->status().nodes.size(), 1u);
    EXPECT_EQ(ann->status().lost_nodes + ann->status().lost_sessions, 0u);
    EXPECT_EQ(ann->members().members.size(), 2u);
    EXPECT_EQ(events_with("is gone"), 0u);
    EXPECT_EQ(events_with(" left "), 0u);
    EXPECT_GT(ann->status().loop.longest_step_seconds, 2.4) << "it is reported";
}

TEST_F(Floods, AKeyHasSoManySessionsAndOperatorsAlwaysGetIn) {
    std::vector<RawPeer> peers;
    std::size_t welcome = 0, refused = 0;
    for (int i = 0; i < 70; ++i) {
        peers.emplace_back(cluster.channel(net::Role::Viewer, "eve"));
        peers.back().send(wire::Hello{.name = "eve"});
    }
    for (RawPeer& peer : peers) {
        while (peer.received<wire::Welcome>() == nullptr && peer.received<wire::Refusal>() == nullptr)
            peer.poll();
        ++(peer.received<wire::Welcome>() ? welcome : refused);
    }
    EXPECT_EQ(welcome, 64u);
    EXPECT_EQ(refused, 6u);
    RawPeer other(cluster.channel(net::Role::Viewer, "other")),
        boss(cluster.channel(net::Role::Operator, "boss"));
    EXPECT_TRUE(other.connect("other"));
    EXPECT_TRUE(boss.connect("boss"));
}

// A removal takes a few bytes on the wire and some hundred in memory.
TEST(EditFloods, AnEditThatDoesNotFitIntoMemoryIsRefusedBeforeItIsDecoded) {
    LoopbackCluster cluster([](master::MasterSettings& settings) { settings.memory_limit = 64u << 20; });
    const auto blobs = std::make_shared<scene::BlobStore>();
    const auto ann = cluster.member("ann", blobs);
    std::vector<scene::Entry> removals;
    for (std::uint64_t i = 0; i < 200'000; ++i) removals.push_back(scene::Remove{ObjectId{1000 + i}});
    const session::EditResult large = ann->submit(std::move(removals));
    ASSERT_FALSE(large.accepted);
    ASSERT_EQ(large.problems.size(), 1u);
    EXPECT_TRUE(large.problems[0].starts_with("the master has no room for an edit of 200000 entries"))
        << large.problems[0];
    EXPECT_NE(large.problems[0].find("of 64 MiB are used"), std::string::npos) << large.problems[0];
    const ObjectId first = ann->new_id();
    for (int i = 0; i < 3; ++i) (void)ann->new_id();
    const session::EditResult small = ann->submit(scene_entries(first, *blobs));
    EXPECT_TRUE(small.accepted) << small.problems.at(0);
}

wire::RequestView view_request(std::uint64_t number, std::uint32_t size, std::uint64_t spp,
                               const char* filter = "") {
    wire::RequestView view;
    view.number = view.request = number;
    view.wanted.name = "view " + std::to_string(number);
    view.wanted.stop.spp = spp;
    view.wanted.view.width = view.wanted.view.height = size;
    view.wanted.view.window = {0, 0, static_cast<std::int32_t>(size), static_cast<std::int32_t>(size)};
    view.wanted.view.camera = view::perspective(glm::dmat4(1.0), 0.8, 1.0);
    view.wanted.view.channels = {frame::Channel::Radiance};
    view.wanted.view.filter = filter;
    view.wanted.picture = session::PictureEncoding::Planes;
    return view;
}

// Sends requests one after another.
struct ViewRequester {
    RawPeer& peer;
    std::size_t answer = 0;
    std::string problem(const wire::RequestView& view) {
        peer.send(view);
        EXPECT_TRUE(peer.wait_for<wire::RequestDone>(answer));
        const auto* done = peer.received<wire::RequestDone>(answer++);
        return done->accepted ? std::string() : done->text;
    }
    bool accepts(const wire::RequestView& view) { return problem(view).empty(); }
};

TEST_F(Floods, ViewersOpenFewAndModerateViews) {
    RawPeer eve = join_as_viewer();
    ViewRequester requester{eve};
    EXPECT_FALSE(requester.accepts(view_request(1, 8192, 1))) << "too many pixels";
    EXPECT_FALSE(requester.accepts(view_request(2, 64, 1u << 20))) << "too many samples";
    for (std::uint64_t i = 3; i < 11; ++i) EXPECT_TRUE(requester.accepts(view_request(i, 64, 16)));
    EXPECT_FALSE(requester.accepts(view_request(11, 64, 16))) << "too many views";
    EXPECT_TRUE(requester.accepts(view_request(10, 128, 16))) << "one of them may change";
}

// The film of such a view takes 8 MiB, and what psvgf keeps several times as much.
TEST(ViewFloods, ViewsWhoseDenoisersDoNotFitIntoMemoryAreRefused) {
    LoopbackCluster cluster([](master::MasterSettings& settings) { settings.memory_limit = 64u << 20; });
    const auto ann = cluster.member("ann", std::make_shared<scene::BlobStore>(), net::Role::Operator);
    RawPeer bob(cluster.channel(net::Role::Viewer, "bob"));
    ASSERT_TRUE(bob.connect("bob"));
    bob.send(wire::JoinScene{.title = "test", .name = "bob"});
    ASSERT_TRUE(bob.wait_for<wire::SceneJoined>());
    ViewRequester requester{bob};
    EXPECT_EQ(requester.problem(view_request(1, 240, 4, "psvgf")), "");
    const std::string problem = requester.problem(view_request(2, 240, 4, "psvgf"));
    EXPECT_TRUE(problem.starts_with("the master has no room for the film and the denoiser of this view"))
        << problem;
    EXPECT_NE(problem.find("close views"), std::string::npos) << problem;
    EXPECT_EQ(requester.problem(view_request(2, 240, 4, "none")), "") << "without a denoiser it fits";
    EXPECT_EQ(requester.problem(view_request(1, 240, 8, "psvgf:levels=5")), "") << "it replaces the first";
    EXPECT_NE(requester.problem(view_request(2, 240, 4, "psvgf")), "");
    EXPECT_EQ(requester.problem(view_request(1, 240, 4, "none")), "");
    EXPECT_EQ(requester.problem(view_request(2, 240, 4, "psvgf")), "") << "the first has made room";

    const auto problem_of_filter = [&](const char* filter) -> std::string {
        try {
            (void)ann->set_filter("view 1", filter);
            return {};
        } catch (const Error& error) {
            return error.what();
        }
    };
    EXPECT_TRUE(problem_of_filter("psvgf").starts_with("the master has no room")) << "a view that is changed";
    EXPECT_EQ(problem_of_filter("gauss"), "");
}

}  // namespace
}  // namespace tessera::test
