// Views of a live scene: coarse first, finally the bits of a batch, and slow watchers delay no others.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <set>

#include "mediator/frame/resolve.h"
#include "mediator/scene/fields.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"
#include "tests/cluster/raw_peer.h"

namespace tessera::test {
namespace {

using namespace scene;
using namespace std::chrono_literals;

session::ViewRequest view_of(std::uint32_t width, std::uint32_t height, std::uint64_t spp) {
    session::ViewRequest request{.stop = {.spp = spp}};
    request.view.width = width;
    request.view.height = height;
    request.view.window = {0, 0, std::int32_t(width), std::int32_t(height)};
    request.view.camera = view::perspective(glm::dmat4(1.0), 0.8, double(width) / height);
    request.view.channels = {frame::Channel::Radiance};
    return request;
}

struct LiveViews : testing::Test {
    LoopbackCluster cluster;
    std::shared_ptr<BlobStore> blobs = std::make_shared<BlobStore>();
    std::unique_ptr<client::Session> ann = cluster.member("ann", blobs);
    ObjectId first = ann->new_id();

    void SetUp() override {
        for (int i = 0; i < 3; ++i) ann->new_id();
        ASSERT_TRUE(ann->submit(scene_entries(first, *blobs)).accepted);
    }
    Update paint(glm::vec3 emission) const {
        return {ObjectId{first.value + 1}, Fields<Material>(&Material::emission).bits(),
                Material{.emission = emission}};
    }
    template <class Done>
    static std::vector<client::Frame> frames_until(client::Session& session, const Done& done) {
        std::vector<client::Frame> frames;
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (auto frame = session.next_frame(deadline, {})) {
            frames.push_back(std::move(*frame));
            if (done(frames.back())) return frames;
        }
        ADD_FAILURE() << "the frame did not come";
        return frames;
    }
    static bool complete(const client::Frame& frame) { return frame.complete; }
};

// The mean is what was asked for, and the bits depend on no node.
TEST_F(LiveViews, GetTheirSamplesWhereTheyAreNeeded) {
    constexpr std::uint64_t Spp = 48;
    std::set<Hash256> hashes;
    for (int nodes = 1; nodes <= 2; ++nodes) {
        cluster.add_node("null");
        session::ViewRequest request = view_of(100, 70, Spp);
        request.film = true;
        ann->request_view(1, request);
        const client::Frame last = frames_until(*ann, complete).back();
        const auto [least, most] = std::ranges::minmax(last.film->counts);
        EXPECT_GE(least, 16u);
        EXPECT_GT(most, Spp);
        std::uint64_t samples = 0;
        for (const std::uint32_t count : last.film->counts) samples += count;
        EXPECT_LE(samples, Spp * 7000);
        EXPECT_DOUBLE_EQ(last.mean_samples, double(samples) / 7000.0);
        EXPECT_GT(last.noise, 0.0);
        EXPECT_GT(samples, Spp * 7000 * 8 / 10);
        hashes.insert(last.film_hash);
        ann->close_view(1);
    }
    EXPECT_EQ(hashes.size(), 1u);
}

TEST_F(LiveViews, HaveAsManySamplesInAllPixelsIfAskedOrWithoutLight) {
    cluster.add_node("embree");
    session::ViewRequest request = view_of(64, 48, 48);
    request.film = true;
    request.stop.uniform = true;
    const auto all_have = [&](std::uint32_t count) {
        ann->request_view(1, request);
        const client::Frame last = frames_until(*ann, complete).back();
        return std::ranges::all_of(last.film->counts, [&](std::uint32_t n) { return n == count; });
    };
    EXPECT_TRUE(all_have(48));
    // Nothing but darkness behind the camera: steps that double all pixels, as far as 48 goes.
    request.stop.uniform = false;
    request.view.camera =
        view::perspective(glm::rotate(glm::dmat4(1.0), 3.14159, glm::dvec3(0.0, 1.0, 0.0)), 0.8, 64.0 / 48.0);
    EXPECT_TRUE(all_have(32));
}

TEST_F(LiveViews, CoarseFirstAndFinallyTheBitsOfABatch) {
    cluster.add_node("embree");
    cluster.add_node("embree");
    session::ViewRequest request = view_of(160, 130, 13);
    request.film = true;
    request.picture = session::PictureEncoding::Png;
    ann->request_view(1, request);
    const auto frames = frames_until(*ann, complete);
    std::vector<std::uint32_t> scales;
    for (const client::Frame& frame : frames) {
        if (scales.empty() || scales.back() != frame.scale) scales.push_back(frame.scale);
        EXPECT_FALSE(frame.picture.empty());
    }
    EXPECT_TRUE(std::is_sorted(scales.rbegin(), scales.rend())) << "scales must not get coarser";
    EXPECT_EQ(scales.front(), 8u);
    const client::Frame& last = frames.back();
    EXPECT_EQ(last.min_samples, 13u);
    ASSERT_TRUE(last.film);
    EXPECT_EQ(frame::film_hash(*last.film), last.film_hash);

    LoopbackCluster other;
    other.add_node("embree");
    auto other_blobs = std::make_shared<BlobStore>();
    const auto session = other.session(other_blobs);
    (void)session->join({.title = "batch", .exclusive = true}, {});
    ASSERT_TRUE(session->submit(scene_entries(first, *other_blobs)).accepted);
    const auto batch = client::render(
        *session, {.view = request.view, .stop = {.spp = 13}, .min_nodes = 1, .film = true}, {}, {});
    EXPECT_EQ(to_hex(frame::film_hash(*batch.film())), to_hex(last.film_hash));
}

TEST_F(LiveViews, OnlyEditsThatChangeThePictureRestartIt) {
    cluster.add_node("null");
    ann->request_view(1, view_of(64, 48, 4));
    const client::Frame before = frames_until(*ann, complete).back();
    ASSERT_TRUE(
        ann->submit({Update{first, Fields<Transform>(&Transform::name).bits(), Transform{.name = "renamed"}}})
            .accepted);
    // The same picture is valid for the new version: reported, not rendered again.
    const auto renamed =
        frames_until(*ann, [&](const client::Frame& frame) { return frame.version != before.version; });
    for (const client::Frame& frame : renamed) EXPECT_TRUE(frame.complete) << "rendered again for a name";
    EXPECT_EQ(renamed.back().film_hash, before.film_hash);
    ASSERT_TRUE(ann->submit({paint({2, 0, 0})}).accepted);
    const auto after = frames_until(*ann, complete);
    EXPECT_GT(after.front().version.number, before.version.number);
    EXPECT_GT(after.front().scale, 1u);
}

// Changing a filter parameter costs a picture but no samples, during rendering and after it.
TEST_F(LiveViews, AnotherFilterKeepsTheFilm) {
    cluster.add_node("null");
    session::ViewRequest request = view_of(64, 48, 16);
    request.view.filter = "gauss:sigma=1";
    request.picture = session::PictureEncoding::Planes;
    ann->request_view(1, request);
    const client::Frame before = frames_until(*ann, complete).back();
    const auto units = [this] { return cluster.session(blobs)->status().units.issued; };
    const std::uint64_t issued = units();
    request.view.filter = "gauss:sigma=4";
    ann->request_view(1, request);
    const auto frames =
        frames_until(*ann, [&](const client::Frame& frame) { return frame.picture != before.picture; });
    for (const client::Frame& frame : frames) EXPECT_TRUE(frame.complete) << "rendered again for a filter";
    EXPECT_EQ(frames.back().film_hash, before.film_hash);
    EXPECT_GT(frames.back().revision, before.revision)
        << "the client can distinguish the new picture from the old";
    EXPECT_EQ(units(), issued);
}

TEST_F(LiveViews, AFilterWithMoreFeaturesGetsThemFromThenOn) {
    cluster.add_node("null", {}, 20us);
    session::ViewRequest request = view_of(64, 48, 64);
    request.view.filter = "none";
    request.picture = session::PictureEncoding::Planes;
    ann->request_view(1, request);
    const client::Frame before = frames_until(*ann, [](const client::Frame& frame) {
                                     return frame.scale == 1 && frame.min_samples >= 8;
                                 }).back();
    request.view.filter = "bilateral";
    ann->request_view(1, request);
    for (const client::Frame& frame : frames_until(*ann, complete)) {
        EXPECT_EQ(frame.scale, 1u) << "restarted";
        EXPECT_GE(frame.min_samples, before.min_samples);
    }
}

TEST_F(LiveViews, PicturesContinueWhileTheCameraIsDragged) {
    cluster.add_node("null", {}, 2us);
    session::ViewRequest request = view_of(320, 240, 1024);
    ann->request_view(1, request);
    std::set<std::uint64_t> revisions;
    const auto end = std::chrono::steady_clock::now() + 3s;
    for (int i = 0; std::chrono::steady_clock::now() < end; ++i) {
        request.view.camera.world_from_camera[3][0] = 0.001 * i;
        ann->set_camera(1, request.view.camera);
        while (auto frame = ann->next_frame(std::chrono::steady_clock::now() + 1ms, {}))
            revisions.insert(frame->revision);
    }
    EXPECT_GE(revisions.size(), 10u) << "a drag must not starve its own pictures";
}

TEST_F(LiveViews, PicturesContinueWhileTheSceneIsEdited) {
    cluster.add_node("null", {}, 2us);
    ann->request_view(1, view_of(320, 240, 1024));
    std::set<std::uint64_t> versions;
    const auto end = std::chrono::steady_clock::now() + 3s;
    for (int i = 0; std::chrono::steady_clock::now() < end; ++i) {
        ann->submit_ahead({paint({0.001f * float(i + 1), 0, 0})}, 5);
        while (auto frame = ann->next_frame(std::chrono::steady_clock::now() + 1ms, {}))
            versions.insert(frame->version.number);
    }
    ann->settle();
    EXPECT_GE(versions.size(), 10u);
}

// The restart waits, since an edit is to be published as soon as another view has its first picture.
TEST_F(LiveViews, AnEndedViewThatIsRequestedAgainFollowsTheScene) {
    cluster.add_node("null", {}, 100us);
    session::ViewRequest still = view_of(32, 24, 1);
    still.min_nodes = 1;
    still.wait_limit = 60s;
    still.film = true;
    const auto first_end = client::render(*ann, still, {}, {}, client::Session::AfterEnd::Keep);
    ASSERT_EQ(first_end.summary.outcome, session::Outcome::Complete);
    ann->request_view(1, view_of(640, 480, 1u << 20));  // its first picture takes half a second
    ann->submit_ahead({paint({2, 0, 0})});
    const auto end = client::render(*ann, still, {}, {});
    EXPECT_EQ(end.summary.outcome, session::Outcome::Complete) << end.summary.message;
    ann->settle();
    ann->refresh();
    EXPECT_EQ(end.summary.version, ann->scene().version());
}

TEST_F(LiveViews, APickFindsObjectPositionAndNormal) {
    cluster.add_node("embree");
    ann->request_view(1, view_of(101, 101, 1));
    const session::PickResult hit = ann->pick(1, 50, 50);
    ASSERT_TRUE(hit.hit);
    // Two coincident triangles: which one is hit depends on the back-end.
    EXPECT_TRUE(hit.object.value == first.value + 2 || hit.object.value == first.value + 3);
    EXPECT_NEAR(hit.position.x, 0.0, 1e-6);
    EXPECT_NEAR(hit.position.y, 0.0, 1e-6);
    EXPECT_NEAR(hit.position.z, -3.0, 1e-6);
    EXPECT_NEAR(hit.distance, 3.0, 1e-6);
    EXPECT_NEAR(std::abs(hit.normal.z), 1.0, 1e-6);
    // tan(0.4) * 3 is half the picture's height at the triangle; pixel (50, 60) looks 10 pixels down.
    const session::PickResult lower = ann->pick(1, 50, 60);
    EXPECT_NEAR(lower.position.y, -std::tan(0.4) * 3.0 * 10.0 / 50.5, 1e-6);
    EXPECT_FALSE(ann->pick(1, 0, 0).hit);
    EXPECT_THROW((void)ann->pick(1, 101, 0), Error);
    EXPECT_THROW((void)ann->pick(2, 0, 0), Error);
    session::ViewRequest other_layers = view_of(101, 101, 1);
    other_layers.view.layers = 2;
    ann->request_view(3, other_layers);
    EXPECT_FALSE(ann->pick(3, 50, 50).hit) << "everything is in layer 0";
}

TEST_F(LiveViews, ASlowWatcherDelaysNoOtherAndGetsTheNewestFrame) {
    cluster.add_node("null");
    auto slow_blobs = std::make_shared<BlobStore>();
    const auto slow = cluster.member("slow", slow_blobs);
    session::ViewRequest request = view_of(64, 48, 4);
    request.name = "main";
    ann->request_view(1, request);
    slow->share_view(1, {.name = "main"});
    for (int i = 1; i <= 20; ++i) {
        ASSERT_TRUE(ann->submit({paint({float(i), 0, 0})}).accepted);
        (void)frames_until(*ann, complete);
    }
    ann->refresh();
    std::size_t count = 0;
    const auto frames = frames_until(*slow, [&](const client::Frame& frame) {
        ++count;
        return frame.complete && frame.version == ann->scene().version();
    });
    EXPECT_LE(count, 6u) << "one in flight when it stopped reading, then only the newest version";
}

TEST_F(LiveViews, AWatcherThatAcknowledgesNothingGetsOneFrame) {
    cluster.add_node("null");
    session::ViewRequest request = view_of(64, 48, 4);
    request.name = "main";
    ann->request_view(1, request);
    RawPeer watcher(cluster.channel(net::Role::Viewer));
    ASSERT_TRUE(watcher.connect("watcher"));
    watcher.send(wire::JoinScene{.title = "test", .name = "watcher"});
    watcher.send(wire::RequestView{.number = 1, .wanted = {.name = "main"}, .share = true});
    ASSERT_TRUE(watcher.wait_for<wire::FrameHeader>());
    for (int i = 1; i <= 20; ++i) {
        ASSERT_TRUE(ann->submit({paint({float(i), 0, 0})}).accepted);
        (void)frames_until(*ann, complete);
        watcher.poll();
    }
    EXPECT_FALSE(watcher.received<wire::FrameHeader>(1));
    watcher.send(wire::FrameTaken{.number = 1, .frame = 0});  // not the one in flight
    for (int i = 0; i < 20; ++i) watcher.poll();
    EXPECT_FALSE(watcher.received<wire::FrameHeader>(1));
}

// Messages sent before the connection broke may be lost.
TEST_F(LiveViews, TheResultOfAViewIsSentAgainAfterAReconnect) {
    cluster.add_node("null");
    session::ViewRequest request = view_of(64, 48, 4);
    request.frames = session::Frames::Last;
    request.picture = session::PictureEncoding::Png;
    RawPeer first_link(cluster.channel(net::Role::Viewer));
    ASSERT_TRUE(first_link.connect("watcher"));
    first_link.send(wire::JoinScene{.title = "test", .name = "watcher"});
    first_link.send(wire::RequestView{.number = 1, .wanted = request});
    ASSERT_TRUE(first_link.wait_for<wire::ViewDone>());

    RawPeer second_link(cluster.channel(net::Role::Viewer));
    ASSERT_TRUE(second_link.connect("watcher", first_link.received<wire::Welcome>()->token));
    ASSERT_TRUE(second_link.wait_for<wire::ViewDone>());
    EXPECT_EQ(second_link.received<wire::Welcome>()->peer_number,
              first_link.received<wire::Welcome>()->peer_number);
    const session::ViewSummary& once = first_link.received<wire::ViewDone>()->summary;
    const session::ViewSummary& again = second_link.received<wire::ViewDone>()->summary;
    EXPECT_EQ(again.outcome, session::Outcome::Complete);
    EXPECT_EQ(again.samples, once.samples);
    EXPECT_TRUE(second_link.wait_for<wire::FrameHeader>()) << "and its picture";
}

TEST_F(LiveViews, InvalidViewsAreRefusedWithAReason) {
    session::ViewRequest request = view_of(64, 48, 4);
    request.view.camera.left = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(ann->request_view(1, request), Error);
    EXPECT_THROW(ann->share_view(1, {.name = "nowhere"}), Error);
    request = view_of(64, 48, 4);
    request.view.filter = "no-such-filter";
    EXPECT_THROW(ann->request_view(1, request), Error);
    request = view_of(64, 48, 0);
    EXPECT_THROW(ann->request_view(1, request), Error);
    request = view_of(8192, 8192, 1);
    request.film = true;
    EXPECT_THROW(ann->request_view(1, request), Error) << "too much film for a watcher";
    request = view_of(64, 48, 1);
    request.name = "taken";
    ann->request_view(1, request);
    EXPECT_THROW(ann->request_view(2, request), Error);
}

TEST_F(LiveViews, AViewWaitingForANodeReportsWhy) {
    cluster.add_node("embree");
    session::ViewRequest request = view_of(64, 48, 1);
    request.view.renderer = view::Renderer::Raster;
    ann->request_view(1, request);
    std::string notice;
    const auto deadline = std::chrono::steady_clock::now() + 30s;
    while (notice.empty() && std::chrono::steady_clock::now() < deadline) {
        EXPECT_FALSE(ann->next_frame(std::chrono::steady_clock::now() + 100ms, {}));
        for (const std::string& text : ann->take_notices()) notice += text;
    }
    EXPECT_NE(notice.find("raster: start one with --backend vulkan"), std::string::npos) << notice;
}

TEST_F(LiveViews, ManyViewsShareTheNodes) {
    cluster.add_node("null");
    for (std::uint64_t number = 1; number <= 5; ++number) ann->request_view(number, view_of(64, 48, 8));
    std::set<std::uint64_t> done;
    frames_until(*ann, [&](const client::Frame& frame) {
        if (frame.complete) done.insert(frame.view);
        return done.size() == 5;
    });
    EXPECT_EQ(done.size(), 5u);
}

}  // namespace
}  // namespace tessera::test
