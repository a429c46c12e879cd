// What clients can do to the views of others, and to those who wait for the scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/hooked_backend.h"
#include "tests/cluster/loopback_cluster.h"
#include "tests/cluster/raw_peer.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

session::ViewRequest view_named(const std::string& name, std::uint64_t spp) {
    session::ViewRequest request{
        .name = name, .stop = {.spp = spp}, .picture = session::PictureEncoding::Planes};
    request.view.width = 64;
    request.view.height = 48;
    request.view.window = {0, 0, 64, 48};
    request.view.camera = view::perspective(glm::dmat4(1.0), 0.8, 64.0 / 48.0);
    request.view.channels = {frame::Channel::Radiance};
    request.view.filter = "none";
    return request;
}

struct OthersViews : testing::Test {
    LoopbackCluster cluster{
        [](master::MasterSettings& settings) { settings.views.unread_limit = std::chrono::seconds(1); }};
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();

    static std::string answer_to_filter(client::Session& session, const std::string& view) {
        try {
            return session.set_filter(view, "gauss");
        } catch (const Error& error) {
            return std::string("refused: ") + error.what();
        }
    }
    bool has_event(const std::string& part) const {
        const auto events = cluster.events();
        return std::ranges::any_of(
            events, [&](const std::string& text) { return text.find(part) != std::string::npos; });
    }
};

TEST_F(OthersViews, OnlyTheOwnersKeyAndOperatorsChangeAFilter) {
    cluster.add_node("null");
    const auto ann = cluster.member("ann", blobs, net::Role::Editor, "ann-key");
    const auto bob = cluster.member("bob", blobs, net::Role::Editor, "bob-key");
    const auto shell = cluster.session(blobs, net::Role::Editor, "ann-key");
    const auto boss = cluster.session(blobs, net::Role::Operator, "boss-key");
    ann->request_view(1, view_named("main", 4));
    bob->share_view(1, {.name = "main"});
    for (const std::string name : {"main", ""}) {
        const std::string refusal = answer_to_filter(*bob, name);
        EXPECT_TRUE(refusal.starts_with("refused: view 'main' belongs to ann (key ann-key)")) << refusal;
        EXPECT_NE(refusal.find("operator"), std::string::npos) << refusal;
    }
    EXPECT_TRUE(answer_to_filter(*ann, "main").starts_with("filter gauss"));
    EXPECT_TRUE(answer_to_filter(*shell, "main").starts_with("filter gauss"));
    EXPECT_TRUE(answer_to_filter(*boss, "").starts_with("filter gauss"));
    // With a view of one's own, one need not name it.
    bob->request_view(2, view_named("bobs", 4));
    EXPECT_TRUE(answer_to_filter(*bob, "").starts_with("filter gauss"));
}

TEST_F(OthersViews, AWatcherThatChangesASharedViewGetsOneOfItsOwn) {
    cluster.add_node("null");
    const auto ann = cluster.member("ann", blobs, net::Role::Editor, "ann-key");
    const auto bob = cluster.member("bob", blobs, net::Role::Editor, "bob-key");
    ann->request_view(1, view_named("main", 4));
    bob->share_view(1, {.name = "main"});
    session::ViewRequest other = view_named("", 4);
    other.view.camera.world_from_camera[3][0] = 1.0;
    bob->request_view(1, other);
    const auto views = ann->members().views;
    ASSERT_EQ(views.size(), 2u);
    EXPECT_EQ(std::ranges::count(views, "main", &session::ViewEntry::name), 1);
    EXPECT_EQ(std::ranges::count(views, "ann", &session::ViewEntry::owner), 1);
}

TEST_F(OthersViews, AWatcherDoesNotTakeOverTheViewOfALostOwner) {
    cluster.add_node("null");
    RawPeer ann(cluster.channel(net::Role::Editor, "ann-key"));
    ASSERT_TRUE(ann.connect("ann"));
    ann.send(wire::JoinScene{.title = "test", .name = "ann", .key = 7});
    ann.send(wire::RequestView{.request = 1, .number = 1, .wanted = view_named("main", 4)});
    ASSERT_TRUE(ann.wait_for<wire::RequestDone>());
    const auto bob = cluster.member("bob", blobs, net::Role::Editor, "bob-key");
    bob->share_view(1, {.name = "main"});
    while (bob->members().members.size() > 1) std::this_thread::sleep_for(20ms);  // ann is silent
    session::ViewRequest other = view_named("", 4);
    other.view.camera.world_from_camera[3][0] = 1.0;
    bob->request_view(1, other);
    const auto views = bob->members().views;
    ASSERT_EQ(views.size(), 2u);
    EXPECT_EQ(std::ranges::count(views, "ann", &session::ViewEntry::owner), 1);
}

// It still sends heartbeats; its picture can be fetched.
TEST_F(OthersViews, AClientThatDoesNotReadItsPictureDoesNotKeepOthersWaiting) {
    cluster.add_node("null");
    RawPeer eve(cluster.channel(net::Role::Editor, "eve-key"));
    ASSERT_TRUE(eve.connect("eve"));
    eve.send(wire::JoinScene{.title = "eve's", .name = "eve", .key = 7, .exclusive = true});
    session::ViewRequest request = view_named("", 4);
    request.frames = session::Frames::Last;
    request.picture = session::PictureEncoding::Png;
    eve.send(wire::RequestView{.number = 1, .wanted = request});
    ASSERT_TRUE(eve.wait_for<wire::ViewDone>());
    for (int i = 0; i < 200; ++i) eve.poll();  // alone, it may take its time
    EXPECT_FALSE(has_event("does not read its picture"));

    std::atomic<bool> has_joined = false;
    std::jthread waiting([&] {
        const auto bob = cluster.session(blobs, net::Role::Editor, "bob-key");
        has_joined = std::holds_alternative<client::Joined>(bob->join({.exclusive = true}, {}));
    });
    const auto deadline = std::chrono::steady_clock::now() + 30s;
    while (!has_joined && std::chrono::steady_clock::now() < deadline) eve.poll();
    EXPECT_TRUE(has_joined);
    EXPECT_TRUE(has_event("eve (eve-key) does not read its picture"));
    EXPECT_TRUE(eve.received<wire::Refusal>());
}

// A view holds edits back until it has shown a frame, so that a drag does not restart it for ever.
TEST_F(OthersViews, AViewThatNeverGetsAFrameDoesNotHoldTheEditsOfOthers) {
    const auto is_released = std::make_shared<std::atomic<bool>>(false);  // outlives the test in the node
    cluster.add_node(hooked([is_released](const view::WorkUnit&, backend::RenderResult&) {
        while (!*is_released) std::this_thread::sleep_for(1ms);
    }));
    const auto ann = cluster.member("ann", blobs, net::Role::Editor, "ann-key");
    const auto bob = cluster.member("bob", blobs, net::Role::Editor, "bob-key");
    bob->request_view(1, view_named("main", 4));
    while (bob->status().units.issued == 0) std::this_thread::sleep_for(1ms);
    const ObjectId id = ann->new_id();
    EXPECT_TRUE(ann->submit({scene::Create{id, scene::Material{}}}).accepted);
    EXPECT_NO_THROW(ann->refresh());
    EXPECT_NE(ann->scene().find(id), nullptr);
    *is_released = true;
}

}  // namespace
}  // namespace tessera::test
