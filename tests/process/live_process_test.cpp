// A live scene across a crash of its master.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <span>
#include <thread>

#include "client/import/import.h"
#include "client/session.h"
#include "mediator/base/hash.h"
#include "mediator/picture/exr_reader.h"
#include "mediator/picture/png_reader.h"
#include "mediator/scene/fields.h"
#include "mediator/view/placed_cameras.h"
#include "tests/process/real_cluster.h"
#include "tests/support/fake_tev.h"

namespace tessera::test {
namespace {

using namespace scene;
using namespace std::chrono_literals;

// A master with a session folder, restarted any number of times, and a node.
struct LiveProcess : testing::Test {
    RealCluster cluster{{"--heartbeat", "0.1", "--checkpoint", "0.3"}, RealCluster::Session::Kept};
    std::optional<ChildProcess> node;
    SteadyClock clock;
    std::shared_ptr<BlobStore> blobs = std::make_shared<BlobStore>();
    std::unique_ptr<client::Session> session;
    ObjectId material;
    session::ViewRequest view{.stop = {.spp = 64}};

    void join() {
        session = client::connect({cluster.endpoint(), cluster.keys()}, blobs, clock,
                                  {.name = "ann", .lost_limit = 60s});
        session->join({.title = "room"}, {});
    }
    void SetUp() override {
        join();
        node.emplace(cluster.start_node("node-1"));
        auto imported = import::import_scene(scene_file("still.glb"), {.first_id = session->new_id()});
        ASSERT_TRUE(imported);
        for (const BlobPtr& blob : imported->blobs) blobs->insert(blob);
        for (const Create& create : imported->objects) {
            if (std::holds_alternative<Material>(create.object)) material = create.id;
        }
        ASSERT_TRUE(session->submit(import::entries(*imported, import::RootEntry::Update)).accepted);
        session->refresh();
        const auto camera = view::choose_camera(session->scene(), "");
        ASSERT_TRUE(camera);
        view.view.width = 96;
        view.view.height = 64;
        view.view.window = {0, 0, 96, 64};
        view.view.camera = view::pose(*camera, 96, 64);
        view.view.channels = {frame::Channel::Radiance};
    }
    std::vector<Entry> paint(float red) const {
        return {Update{material, Fields<Material>(&Material::base_color).bits(),
                       Material{.base_color = {red, 0.5f, 0.5f, 1.0f}}}};
    }
    Hash256 finished_film() {
        const auto deadline = std::chrono::steady_clock::now() + 120s;
        while (const auto frame = session->next_frame(deadline, {})) {
            if (frame->complete) return frame->film_hash;
        }
        ADD_FAILURE() << "the frame was not finished";
        return {};
    }
};

TEST_F(LiveProcess, KilledAtRandomTimesKeepsEveryAcknowledgedEdit) {
    std::mt19937 random(7);
    float last = 0.0f;
    std::uint64_t edits = 0;
    for (int kill = 0; kill < 50; ++kill) {
        std::jthread killer([&, after = std::chrono::milliseconds(random() % 120)] {
            std::this_thread::sleep_for(after);
            cluster.kill_master();
            cluster.start_master();
        });
        for (int i = 0; i < 20; ++i) {
            last = float(random() % 1000) / 1000.0f;
            const auto result = session->submit(paint(last));  // also across the master's death
            ASSERT_TRUE(result.accepted) << result.problems.front();
            ++edits;
        }
        killer.join();
        session->refresh();
        ASSERT_EQ(session->scene().find_as<Material>(material)->base_color.x, last) << "kill " << kill;
    }
    const auto late = client::connect({cluster.endpoint(), cluster.keys()}, std::make_shared<BlobStore>(),
                                      clock, {.name = "late"});
    late->join({.title = "room"}, {});
    EXPECT_EQ(late->scene().state_hash(), session->scene().state_hash());
    EXPECT_EQ(late->history(256).size(), 256u) << "of " << edits;
}

TEST_F(LiveProcess, FinishedFrameMatchesAnUninterruptedOneBitwise) {
    view.stop.spp = 256;  // seconds on one thread: it is not finished before it is interrupted
    session->request_view(1, view);
    const Hash256 whole = finished_film();
    session->close_view(1);
    view.name = "interrupted";
    session->request_view(2, view);
    for (int kill = 0; kill < 3; ++kill) {
        std::this_thread::sleep_for(150ms);
        cluster.kill_master();
        cluster.start_master();
        (void)session->members();  // it has joined again
    }
    EXPECT_EQ(to_hex(finished_film()), to_hex(whole));
}

TEST_F(LiveProcess, WatchShowsDenoisedPicturesUnlessAskedNotTo) {
    const auto watched = [&](const std::string& file, const std::vector<std::string>& more) {
        std::vector<std::string> arguments{
            "watch", "--master", cluster.endpoint(), "--keys", cluster.keys(),         "--size", "96x64",
            "--spp", "4",        "--once",           "-o",     cluster.folder() / file};
        arguments.insert(arguments.end(), more.begin(), more.end());
        ChildProcess watch(cluster.folder().path(), "watch-" + file, "tessera", arguments);
        EXPECT_EQ(watch.wait(60s).value_or(-1), 0) << watch.err();
        std::ifstream stream(cluster.folder() / file, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    const std::string usual = watched("usual.png", {}), denoised = watched("psvgf.png", {"--denoise=psvgf"}),
                      samples = watched("none.png", {"--denoise=none"});
    EXPECT_GT(usual.size(), 1000u);
    EXPECT_EQ(usual, denoised);
    EXPECT_NE(usual, samples);
    EXPECT_EQ(watched("usual.exr", {}), watched("none.exr", {"--filter", "none"}))
        << "light for other programs";
}

TEST_F(LiveProcess, WatchShowsFramesAndLayersInTev) {
    test::FakeTev tev;
    ChildProcess watch(
        cluster.folder().path(), "watch-tev", "tessera",
        {"watch", "--master", cluster.endpoint(), "--keys", cluster.keys(), "--size", "96x64", "--spp", "32",
         "--once", "--filter", "none", "-o", cluster.folder() / "now.exr", "--tev", tev.address()});
    tev.read();
    ASSERT_EQ(watch.wait(60s).value_or(-1), 0) << watch.err();
    EXPECT_EQ(tev.name, "tessera watch");
    EXPECT_EQ(tev.width, 96);
    EXPECT_EQ(tev.height, 64);
    for (const char* channel :
         {"R", "G", "B", "variance.R", "noise.Y", "albedo.G", "normal.Z", "depth.Z", "samples.count"})
        EXPECT_TRUE(std::ranges::count(tev.channels, channel) == 1) << channel;
    const frame::Image picture = picture::read_exr(cluster.folder() / "now.exr").image;
    for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
        ASSERT_EQ(tev.planes["R"][i], picture.pixel(i)[0]) << i;
        ASSERT_EQ(tev.planes["B"][i], picture.pixel(i)[2]) << i;
    }
    EXPECT_GE(std::ranges::min(tev.planes["samples.count"]), 16.0f);

    ChildProcess refused(
        cluster.folder().path(), "watch-no-tev", "tessera",
        {"watch", "--master", cluster.endpoint(), "--keys", cluster.keys(), "--tev", "127.0.0.1:1"});
    EXPECT_EQ(refused.wait(60s).value_or(-1), 69);
    EXPECT_NE(refused.err().find("cannot reach tev at 127.0.0.1:1"), std::string::npos) << refused.err();
}

TEST_F(LiveProcess, WatchWritesANoiseMap) {
    const std::string file = cluster.folder() / "noise.png";
    std::vector<std::string> arguments{"watch",
                                       "--master",
                                       cluster.endpoint(),
                                       "--keys",
                                       cluster.keys(),
                                       "--size",
                                       "96x64",
                                       "--spp",
                                       "64",
                                       "--once",
                                       "-o",
                                       cluster.folder() / "now.png",
                                       "--noise-map",
                                       file};
    ChildProcess watch(cluster.folder().path(), "watch-noise", "tessera", arguments);
    ASSERT_EQ(watch.wait(60s).value_or(-1), 0) << watch.err();
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(stream), {});
    const auto map = picture::read_png(std::as_bytes(std::span(bytes)));
    ASSERT_TRUE(map) << map.error().what();
    EXPECT_EQ(map->width, 96u);
    EXPECT_EQ(map->height, 64u);
    const auto [least, most] = std::ranges::minmax(map->values);
    EXPECT_LT(least, most) << "the same noise everywhere";

    arguments.back() = "noise.exr";
    ChildProcess refused(cluster.folder().path(), "watch-refused", "tessera", arguments);
    EXPECT_EQ(refused.wait(60s).value_or(-1), 64);
    EXPECT_NE(refused.err().find("--noise-map: 'noise.exr' does not end with .png"), std::string::npos);
}

TEST_F(LiveProcess, SamplesMergedBeforeTheCrashAreKept) {
    view.stop.spp = 1u << 20;
    session->request_view(1, view);
    std::uint64_t before = 0, after = 0;
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    while (before < 256) {
        const auto frame = session->next_frame(deadline, {});
        ASSERT_TRUE(frame);
        if (frame->scale == 1) before = frame->min_samples;
    }
    std::this_thread::sleep_for(1s);  // three checkpoints
    cluster.kill_master();
    node->signal(SIGSTOP);  // nothing new is rendered
    cluster.start_master();
    (void)session->members();
    while (const auto frame = session->next_frame(std::chrono::steady_clock::now() + 3s, {})) {
        if (frame->scale == 1) after = frame->min_samples;
        if (after >= 256) break;
    }
    node->signal(SIGCONT);
    EXPECT_GE(after, 256u);
}

std::string newest_checkpoint(const std::string& folder) {
    std::string newest;
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
        const std::string name = file.path().filename().string();
        if (name.starts_with("checkpoint-")) newest = std::max(newest, name);
    }
    return newest;
}

TEST(LiveShutdown, AMasterThatIsAskedToStopWritesACheckpoint) {
    RealCluster cluster({"--heartbeat", "0.1", "--checkpoint", "3600"}, RealCluster::Session::Kept);
    const SteadyClock clock;
    std::string before;
    ObjectId lamp;
    {
        const auto ann = client::connect({cluster.endpoint(), cluster.keys()}, std::make_shared<BlobStore>(),
                                         clock, {.name = "ann"});
        ann->join({.title = "room"}, {});
        ASSERT_TRUE(ann->submit({Create{ann->new_id(), Material{.name = "first"}}}).accepted);
        std::this_thread::sleep_for(500ms);  // the first checkpoint may be written at once
        before = newest_checkpoint(cluster.folder() / "session");
        lamp = ann->new_id();
        ASSERT_TRUE(ann->submit({Create{lamp, Light{.name = "lamp"}}}).accepted);
    }
    cluster.master().signal(SIGTERM);
    ASSERT_EQ(cluster.master().wait(30s).value_or(-1), 0) << cluster.master().err();
    EXPECT_GT(newest_checkpoint(cluster.folder() / "session"), before);
    cluster.start_master();
    const auto bob = client::connect({cluster.endpoint(), cluster.keys()}, std::make_shared<BlobStore>(),
                                     clock, {.name = "bob"});
    bob->join({.title = "room"}, {});
    ASSERT_NE(bob->scene().find_as<Light>(lamp), nullptr);
    EXPECT_EQ(bob->scene().find_as<Light>(lamp)->name, "lamp");
    const std::string log = cluster.master().err();
    EXPECT_NE(log.find(" 0 edits were replayed from the journal"), std::string::npos) << log;
}

}  // namespace
}  // namespace tessera::test
