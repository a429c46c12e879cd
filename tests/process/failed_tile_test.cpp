// Samples that fail on every node, as the user of `tessera render` sees them.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <mutex>
#include <optional>
#include <span>

#include "master/render_master.h"
#include "mediator/net/zmq_channel.h"
#include "mediator/picture/png_reader.h"
#include "tests/cluster/hooked_backend.h"
#include "tests/process/real_cluster.h"

namespace tessera::test {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

// A node that runs until the process ends or is stopped.
std::unique_ptr<node::RenderNode> make_node(const std::shared_ptr<net::ZmqContext>& context,
                                            const std::string& endpoint, const SteadyClock& clock,
                                            const std::string& name,
                                            const LoopbackCluster::MakeBackend& make) {
    auto blobs = std::make_shared<scene::BlobStore>();
    return std::make_unique<node::RenderNode>(
        net::make_zmq_client(context, {.endpoint = endpoint, .keys = {}}),
        make({.threads = 1, .blobs = blobs}), blobs, clock,
        node::NodeSettings{.name = name, .backend = "test", .reproducible = true, .workers = 1},
        node::NodeCallbacks{.event = [](const node::Report&) {}, .reconnect = {}});
}

// A master and nodes in this process, which a client of another process reaches over TCP on loopback.
class ReachableCluster {
  public:
    explicit ReachableCluster(const std::string& endpoint = free_loopback_endpoint())
        : endpoint_(endpoint),
          master_(net::make_zmq_server(context_, {.endpoint = endpoint_, .keys = {}}),
                  std::make_shared<scene::BlobStore>(), clock_, quick_heartbeats(),
                  [this](const master::Event& event) {
                      const std::scoped_lock lock(mutex_);
                      events_ += event.text + "\n";
                  }),
          master_thread_([this](std::stop_token stop) { master_.run(stop); }) {}
    ~ReachableCluster() {
        for (std::jthread& thread : node_threads_) thread.request_stop();
        node_threads_.clear();
    }

    void add_node(const LoopbackCluster::MakeBackend& make) {
        nodes_.push_back(
            make_node(context_, endpoint_, clock_, "node-" + std::to_string(nodes_.size() + 1), make));
        node::RenderNode& node = *nodes_.back();
        node_threads_.emplace_back([&node](std::stop_token stop) { node.run(stop, stop); });
    }
    const std::string& endpoint() const { return endpoint_; }
    std::string events() const {
        const std::scoped_lock lock(mutex_);
        return events_;
    }

  private:
    static master::MasterSettings quick_heartbeats() {
        master::MasterSettings settings{.software = "test"};
        settings.liveness = {.interval = 200ms, .missed = 10};
        return settings;
    }

    SteadyClock clock_;
    std::string endpoint_;
    mutable std::mutex mutex_;  // protects events_
    std::string events_;
    std::shared_ptr<net::ZmqContext> context_ = net::make_zmq_context();
    master::RenderMaster master_;
    std::jthread master_thread_;
    std::vector<std::unique_ptr<node::RenderNode>> nodes_;
    std::vector<std::jthread> node_threads_;
};

TEST(FailedTile, IsMarkedInThePictureAndNamedByTheCommandWhichExitsWith3) {
    ReachableCluster cluster;
    for (int i = 0; i < 2; ++i) {
        cluster.add_node(hooked([](const view::WorkUnit& unit, auto&) {
            if (unit.tile.x == 32 && unit.tile.y == 0) throw Error(ErrorCode::Internal, "a bad shader");
        }));
    }
    TemporaryFolder folder;
    ChildProcess render(
        folder.path(), "frame", "tessera",
        {"render", scene_file("still.glb"), "--master", cluster.endpoint(), "--wait-nodes", "2:60", "--size",
         "96x64", "--spp", "4", "--seed", "5", "-o", folder / "frame.png", "--json"});
    ASSERT_EQ(render.wait(1min).value_or(-1), 3) << render.err();
    const std::string message = render.err();
    EXPECT_NE(message.find("1 tile could not be rendered by any node that tried: "), std::string::npos)
        << message;
    EXPECT_NE(
        message.find("a bad shader; replay it with: tessera probe SCENE --pixel 32,0 --sample 0 --seed 5"),
        std::string::npos)
        << message;

    const json report = json::parse(render.out());
    EXPECT_EQ(report["nodes"].size(), 2u);
    ASSERT_EQ(report["failed_tiles"].size(), 1u);
    const json& tile = report["failed_tiles"][0];
    EXPECT_EQ(tile["x"], 32);
    EXPECT_EQ(tile["y"], 0);
    EXPECT_EQ(tile["samples"], 0);

    // Magenta and black stripes.
    std::ifstream file(folder / "frame.png", std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(file), {});
    const auto picture = picture::read_png(std::as_bytes(std::span(bytes)));
    ASSERT_TRUE(picture);
    ASSERT_EQ(picture->components, 3u);
    std::size_t marked = 0;
    for (std::size_t y = 0; y < 32; ++y) {
        for (std::size_t x = 32; x < 64; ++x) {
            const auto pixel = picture->pixel(y * 96 + x);
            EXPECT_EQ(pixel[1], 0.0f) << x << " " << y;
            if (pixel[0] > 0.5f && pixel[2] > 0.5f) ++marked;
        }
    }
    EXPECT_EQ(marked, 32u * 32u / 2u);
}

// A child of this process that is a node, and crashes if it renders a tile; made before there are threads.
class CrashingNode {
  public:
    CrashingNode(const std::string& endpoint, const std::string& name) : pid_(::fork()) {
        if (pid_ != 0) return;
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        const rlimit no_core{0, 0};
        ::setrlimit(RLIMIT_CORE, &no_core);
        ::signal(SIGSEGV, SIG_DFL);
        const SteadyClock clock;
        const auto context = net::make_zmq_context();
        // The null back-end calls the hook at the end of a unit.
        const auto crash = [](const view::WorkUnit& unit, auto&) {
            if (unit.tile.x == 32 && unit.tile.y == 0) ::raise(SIGSEGV);
        };
        make_node(context, endpoint, clock, name, hooked(crash, 20us))->run({}, {});
        ::_exit(0);
    }
    ~CrashingNode() {
        if (status_) return;
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
    CrashingNode(const CrashingNode&) = delete;
    CrashingNode& operator=(const CrashingNode&) = delete;
    bool has_crashed() {
        int status = 0;
        if (!status_ && ::waitpid(pid_, &status, WNOHANG) == pid_) status_ = status;
        return status_ && WIFSIGNALED(*status_) && WTERMSIG(*status_) == SIGSEGV;
    }

  private:
    pid_t pid_;
    std::optional<int> status_;
};

TEST(FailedTile, ThatKilledTwoNodesIsLeftOutAndTheOthersFinish) {
    const std::string endpoint = free_loopback_endpoint();
    CrashingNode nodes[3]{{endpoint, "crash-1"}, {endpoint, "crash-2"}, {endpoint, "crash-3"}};
    ReachableCluster cluster(endpoint);
    TemporaryFolder folder;
    ChildProcess render(
        folder.path(), "frame", "tessera",
        {"render", scene_file("still.glb"), "--master", endpoint, "--wait-nodes", "3:60", "--size", "96x64",
         "--spp", "4", "--seed", "5", "-o", folder / "frame.exr", "--json"});
    ASSERT_EQ(render.wait(1min).value_or(-1), 3) << render.err() << cluster.events();
    const json report = json::parse(render.out());
    ASSERT_EQ(report["failed_tiles"].size(), 1u) << report.dump(1);
    EXPECT_EQ(report["failed_tiles"][0]["x"], 32);
    EXPECT_EQ(report["failed_tiles"][0]["y"], 0);
    EXPECT_NE(
        render.err().find("ended while they rendered it; replay it with: tessera probe SCENE --pixel 32,0"),
        std::string::npos)
        << render.err();
    EXPECT_EQ(std::ranges::count_if(nodes, [](CrashingNode& node) { return node.has_crashed(); }), 2);
    const std::string log = cluster.events();
    EXPECT_NE(log.find(" is gone: its connection broke; it rendered unit "), std::string::npos) << log;
    EXPECT_NE(log.find(" (32x32 pixels at 32,0, samples 0.."), std::string::npos) << log;
    EXPECT_NE(log.find("a tile is left out: unit "), std::string::npos) << log;
}

}  // namespace
}  // namespace tessera::test
