// The master's event loop never takes long, whatever its peers ask for: 20 ms of CPU time a step at most.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <future>
#include <thread>

#include "mediator/scene/blob_file.h"
#include "mediator/scene/fields.h"
#include "mediator/wire/blob_transfer.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"
#include "tests/cluster/raw_peer.h"

namespace tessera::test {
namespace {

using namespace scene;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

session::ViewRequest small_view() {
    session::ViewRequest request{.stop = {.spp = 1}};
    request.view.width = request.view.height = 32;
    request.view.window = {0, 0, 32, 32};
    request.view.camera = view::perspective(glm::dmat4(1.0), 0.8, 1.0);
    request.view.channels = {frame::Channel::Radiance};
    return request;
}

struct LoopSteps : testing::Test {
    const fs::path folder = fs::temp_directory_path() / ("tessera-loop-steps-" + std::to_string(::getpid()));
    std::unique_ptr<LoopbackCluster> cluster;
    std::shared_ptr<BlobStore> blobs = std::make_shared<BlobStore>();
    std::unique_ptr<client::Session> ann;
    ObjectId group;
    std::string long_steps;  // of this run, a line each

    LoopSteps() { fs::remove_all(folder); }
    ~LoopSteps() override {
        ann.reset();
        cluster.reset();
        fs::remove_all(folder);
    }
    // With a session folder, or all in memory.
    void start(bool records, Duration checkpoint_interval = std::chrono::hours(1)) {
        cluster = std::make_unique<LoopbackCluster>([&](master::MasterSettings& settings) {
            if (records) settings.session_folder = folder;
            settings.checkpoint_interval = checkpoint_interval;
        });
        cluster->add_node("null");
        ann = cluster->member("ann", blobs);
        const ObjectId first = ann->new_id();
        for (int i = 0; i < 3; ++i) (void)ann->new_id();
        ASSERT_TRUE(ann->submit(scene_entries(first, *blobs)).accepted);
        group = ann->new_id();
        ASSERT_TRUE(ann->submit({Create{group, Transform{.name = "group"}}}).accepted);
    }
    std::vector<Entry> objects(int count) {
        std::vector<Entry> many;
        many.reserve(static_cast<std::size_t>(count));
        for (int i = 0; i < count; ++i)
            many.push_back(Create{ann->new_id(), Transform{.name = "part " + std::to_string(i)}});
        return many;
    }
    void create(int count) {
        const auto result = ann->submit(objects(count));
        ASSERT_TRUE(result.accepted) << result.problems.at(0);
    }
    void expect_short_steps(const std::string& what) {
        const session::LoopStatus loop = ann->status().loop;
        const std::string step = what + ": " + std::to_string(1e3 * loop.longest_cpu_seconds) +
                                 " ms at most, " + loop.longest_part + "\n";
        std::fputs(step.c_str(), stdout);
        if (loop.longest_cpu_seconds >= 0.02) long_steps += step;
    }
    // A step that is long for what it does is long in each run; the time that a virtual machine's host takes
    // from a thread counts as the thread's as well, but does not come thrice at the same place.
    template <class Scenario>
    void expect_short_steps_in(Scenario scenario) {
        std::string all;
        for (int run = 0; run < 3; ++run) {
            long_steps.clear();
            scenario();
            if (long_steps.empty() || HasFailure()) return;
            all += long_steps;
            ann.reset();
            cluster.reset();
            blobs = std::make_shared<BlobStore>();
            fs::remove_all(folder);
        }
        ADD_FAILURE() << "20 ms of CPU time are exceeded in each of three runs:\n" << all;
    }
    bool nodes_are_current() const {
        const auto status = ann->status();
        return std::all_of(status.nodes.begin(), status.nodes.end(),
                           [&](const auto& node) { return node.version == status.version; });
    }
    // Within a minute; all of them keep in touch meanwhile.
    template <class Message>
    static bool all_have(std::vector<RawPeer>& peers) {
        const auto has = [](const RawPeer& peer) { return peer.received<Message>() != nullptr; };
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (!std::ranges::all_of(peers, has) && std::chrono::steady_clock::now() < deadline) {
            for (RawPeer& peer : peers) peer.poll();
        }
        return std::ranges::all_of(peers, has);
    }
    void wait_for_nodes() {
        for (int i = 0; i < 3000 && !nodes_are_current(); ++i) std::this_thread::sleep_for(10ms);
        EXPECT_TRUE(nodes_are_current());
    }
};

TEST_F(LoopSteps, AreShortWhileManyObjectsAreCreatedChangedAndRemoved) {
    expect_short_steps_in([&] {
        start(true);
        constexpr int Count = 100'000;
        std::vector<Entry> changes, removals;
        std::vector<Entry> creations = objects(Count);
        for (const Entry& creation : creations) {
            changes.push_back(Update{id(creation), Fields<Transform>(&Transform::name).bits(),
                                     Transform{.name = "renamed"}});
            removals.push_back(Remove{id(creation)});
        }
        for (auto* entries : {&creations, &changes, &removals}) {
            const auto result = ann->submit(std::move(*entries));
            ASSERT_TRUE(result.accepted) << result.problems.at(0);
        }
        ASSERT_TRUE(ann->undo().accepted);
        ASSERT_TRUE(ann->redo().accepted);
        wait_for_nodes();
        ann->refresh();
        EXPECT_EQ(ann->scene().objects().size(), 6u);
        expect_short_steps("an edit of 100,000 objects");
    });
}

TEST_F(LoopSteps, AreShortWhileALargeSceneIsReadMirroredAndClosed) {
    expect_short_steps_in([&] {
        start(false);
        for (int i = 0; i < 3; ++i) create(100'000);
        // They do not decode what they receive, which would take the test most of its time.
        std::vector<RawPeer> readers;
        for (int i = 0; i < 20; ++i) {
            readers.emplace_back(cluster->channel(net::Role::Editor, "reader"));
            ASSERT_TRUE(readers.back().connect("reader " + std::to_string(i)));
            readers.back().send(wire::JoinScene{.key = 100 + static_cast<std::uint64_t>(i)});
        }
        ASSERT_TRUE(all_have<wire::SceneJoined>(readers));
        for (RawPeer& reader : readers) reader.send(wire::ReadScene{.request = 1});
        cluster->add_node("null");
        ASSERT_TRUE(all_have<wire::SceneContent>(readers));
        for (RawPeer& reader : readers) {
            const BlobRef content = reader.received<wire::SceneContent>()->blob;
            EXPECT_GT(content.byte_size, 300'000u * 10);
            for (std::uint64_t at = 0; at < content.byte_size; at += wire::BlobChunkBytes)
                reader.send(wire::BulkMessage(wire::BlobRequest{content.hash, at}));
        }
        EXPECT_TRUE(all_have<wire::BlobChunk>(readers));
        wait_for_nodes();
        expect_short_steps("300,000 objects for 20 readers and a node");
        readers.clear();
        ann->close_scene();
        ann = cluster->member("ann", std::make_shared<BlobStore>());
        ann->refresh();
        EXPECT_EQ(ann->scene().objects().size(), 1u);
        expect_short_steps("its end");
    });
}

TEST_F(LoopSteps, AreShortWhileACheckpointIsWritten) {
    expect_short_steps_in([&] {
        start(true, 500ms);
        create(100'000);
        const auto written = [&] { return ann->status().scene.checkpoints; };
        const std::uint64_t before = written();
        ASSERT_TRUE(ann->submit({Update{group, Fields<Transform>(&Transform::name).bits(),
                                        Transform{.name = "another name"}}})
                        .accepted);
        for (int i = 0; i < 3000 && written() < before + 1; ++i) std::this_thread::sleep_for(10ms);
        EXPECT_GT(written(), before);
        expect_short_steps("a checkpoint of 100,000 edited objects");
    });
}

TEST_F(LoopSteps, AreShortWhileBlobsArrive) {
    expect_short_steps_in([&] {
        start(false);
        const char* const gib = std::getenv("TESSERA_BLOB_GIB");  // 4 with the label `long`
        constexpr std::size_t Size = std::size_t{256} << 20;
        const std::size_t count = 4 * (gib == nullptr ? 1 : std::strtoul(gib, nullptr, 10));
        std::vector<Entry> meshes;
        for (std::size_t i = 0; i < count; ++i) {
            std::vector<std::byte> bytes(Size, std::byte(i));
            const BlobPtr blob = blobs->insert(bytes);
            meshes.push_back(
                Create{ann->new_id(),
                       Texture{.name = "large", .width = 8192, .height = 8192, .texels = reference(*blob)}});
        }
        const auto result = ann->submit(std::move(meshes));
        ASSERT_TRUE(result.accepted) << result.problems.at(0);
        EXPECT_GE(ann->status().blob_bytes, count * Size);
        expect_short_steps(std::to_string(count / 4) + " GiB of blobs");
    });
}

TEST_F(LoopSteps, AreShortWhileALargeFrameIsDelivered) {
    expect_short_steps_in([&] {
        start(false);
        session::ViewRequest request{
            .stop = {.spp = 1}, .picture = session::PictureEncoding::Planes, .film = true};
        request.view.width = request.view.height = 2048;
        request.view.window = {0, 0, 2048, 2048};
        request.view.camera = view::perspective(glm::dmat4(1.0), 0.8, 1.0);
        request.view.channels = {frame::Channel::Radiance};
        EXPECT_EQ(client::render(*ann, request, {}, {}).summary.outcome, session::Outcome::Complete);
        expect_short_steps("a frame of 4.2 million pixels with its film");
        // A view that shows every frame, with two watchers of the same tiles.
        const auto bob = cluster->member("bob", std::make_shared<BlobStore>());
        request.name = "main";
        ann->request_view(2, request);
        bob->share_view(2, request);
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        for (client::Session* watcher : {ann.get(), bob.get()}) {
            bool has_all = false;
            while (!has_all && std::chrono::steady_clock::now() < deadline) {
                const auto frame = watcher->next_frame(std::chrono::steady_clock::now() + 100ms, {});
                has_all = frame && frame->complete && frame->film;
            }
            EXPECT_TRUE(has_all);
        }
        expect_short_steps("the same for two watchers");
    });
}

// A named pipe that no one reads stands in for a disk that does not answer: the file of a blob cannot be opened.
TEST_F(LoopSteps, DoNotWaitForTheDisk) {
    expect_short_steps_in([&] {
        start(true);
        const auto bob = cluster->member("bob", std::make_shared<BlobStore>());
        const BlobPtr blob = blobs->insert(std::vector<std::byte>(4096, std::byte{7}));
        const fs::path pipe = blob_path(folder / "blobs", reference(*blob)).string() + "." +
                              std::to_string(::getpid()) + ".part";
        ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
        auto edit = std::async(std::launch::async, [&] {
            return ann->submit(
                {Create{ann->new_id(),
                        Texture{.name = "slow", .width = 32, .height = 32, .texels = reference(*blob)}}});
        });
        // Meanwhile views open, pictures arrive, the status is answered; only edits wait.
        std::uint64_t pictures = 0;
        const auto end = std::chrono::steady_clock::now() + 5s;
        while (std::chrono::steady_clock::now() < end) {
            EXPECT_EQ(bob->status().nodes.size(), 1u);
            bob->request_view(pictures + 1, small_view());
            if (bob->next_frame(std::chrono::steady_clock::now() + 1s, {})) ++pictures;
            bob->close_view(pictures);
        }
        EXPECT_GT(pictures, 3u);
        EXPECT_EQ(edit.wait_for(0s), std::future_status::timeout);
        const session::LoopStatus loop = bob->status().loop;
        EXPECT_LT(loop.longest_step_seconds, 1.0);
        const int file = ::open(pipe.c_str(), O_RDWR | O_CLOEXEC);
        const session::EditResult result = edit.get();
        // A pipe cannot be synced either, which may be noticed before the answer.
        const std::string problem = result.problems.empty() ? "" : result.problems.front();
        EXPECT_TRUE(result.accepted || problem.find("Invalid argument") != std::string::npos) << problem;
        ::close(file);
        expect_short_steps("a disk that stands still for 5 s");
    });
}

}  // namespace
}  // namespace tessera::test
