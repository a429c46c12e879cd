// Samples that fail on every node, as the user of `tessera render` sees them.
#include <gtest/gtest.h>

#include <fstream>
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

// A master and nodes in this process, which a client of another process reaches over TCP on loopback.
class ReachableCluster {
  public:
    ReachableCluster()
        : endpoint_(free_loopback_endpoint()),
          master_(net::make_zmq_server(context_, {.endpoint = endpoint_, .keys = {}}),
                  std::make_shared<scene::BlobStore>(), clock_, {.software = "test"},
                  [](const master::Event&) {}),
          master_thread_([this](std::stop_token stop) { master_.run(stop); }) {}
    ~ReachableCluster() {
        for (std::jthread& thread : node_threads_) thread.request_stop();
        node_threads_.clear();
    }

    void add_node(const LoopbackCluster::MakeBackend& make) {
        auto blobs = std::make_shared<scene::BlobStore>();
        nodes_.push_back(std::make_unique<node::RenderNode>(
            net::make_zmq_client(context_, {.endpoint = endpoint_, .keys = {}}),
            make({.threads = 1, .blobs = blobs}), blobs, clock_,
            node::NodeSettings{.name = "node-" + std::to_string(nodes_.size() + 1),
                               .backend = "test",
                               .reproducible = true,
                               .workers = 1},
            node::NodeCallbacks{.event = [](const node::Report&) {}, .reconnect = {}}));
        node::RenderNode& node = *nodes_.back();
        node_threads_.emplace_back([&node](std::stop_token stop) { node.run(stop, stop); });
    }
    const std::string& endpoint() const { return endpoint_; }

  private:
    SteadyClock clock_;
    std::string endpoint_;
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

}  // namespace
}  // namespace tessera::test
