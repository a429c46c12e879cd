// Views are rendered by the nodes that have their renderer.
#include <gtest/gtest.h>

#include <algorithm>

#include "mediator/backend/catalog.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

// A null back-end that also has the raster renderer, with the same gradient.
class Drawing final : public backend::Backend {
  public:
    explicit Drawing(const backend::BackendSettings& settings)
        : inner_(backend::find_backend("null").make(settings)) {}

    backend::Capabilities capabilities() const override {
        backend::Capabilities capabilities = inner_->capabilities();
        capabilities.renderers.insert(view::Renderer::Raster);
        return capabilities;
    }
    Version version() const override { return inner_->version(); }
    std::unique_ptr<backend::EditScope> begin_edit() override { return inner_->begin_edit(); }
    backend::RenderResult render(const view::View& view, const view::WorkUnit& unit,
                                 std::stop_token stop) override {
        view::View traced = view;
        traced.renderer = view::Renderer::PathTracing;
        return inner_->render(traced, unit, stop);
    }
    std::vector<std::string> probe(const view::View& view, std::uint32_t x, std::uint32_t y,
                                   std::uint64_t sample) override {
        return inner_->probe(view, x, y, sample);
    }

  private:
    std::unique_ptr<Backend> inner_;
};

struct RenderersTest : testing::Test {
    client::ViewResult render(view::Renderer renderer) {
        session::ViewRequest request{.stop = {.spp = 16}, .min_nodes = 1, .film = true};
        request.view.width = request.view.height = 200;
        request.view.window = {0, 0, 200, 200};
        request.view.channels = {frame::Channel::Radiance};
        request.view.renderer = renderer;
        request.wait_limit = 500ms;
        return client::render(*session, request, {}, {});
    }
    void open() { session = cluster.batch(blobs); }

    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    LoopbackCluster cluster;
    std::unique_ptr<client::Session> session;
};

TEST_F(RenderersTest, WithoutARasterNodeAViewEndsWithTheRemedy) {
    cluster.add_node("null");
    open();
    const client::ViewResult none = render(view::Renderer::Raster);
    EXPECT_EQ(none.summary.outcome, session::Outcome::NoNodes);
    EXPECT_NE(none.summary.message.find("no node has the renderer raster: start one with --backend vulkan"),
              std::string::npos)
        << none.summary.message;
    EXPECT_EQ(render(view::Renderer::PathTracing).summary.outcome, session::Outcome::Complete);
}

// From raster to path and back, on the same version of the scene.
TEST_F(RenderersTest, OnlyRasterNodesGetUnitsOfARasterView) {
    cluster.add_node("null");
    cluster.add_node(
        [](const backend::BackendSettings& settings) { return std::make_unique<Drawing>(settings); });
    open();
    const client::ViewResult drawn = render(view::Renderer::Raster);
    ASSERT_EQ(drawn.summary.outcome, session::Outcome::Complete) << drawn.summary.message;
    std::size_t taking_part = 0;
    for (const auto& node : drawn.summary.nodes) taking_part += node.samples > 0 ? 1 : 0;
    EXPECT_EQ(taking_part, 1u);
    const client::ViewResult traced = render(view::Renderer::PathTracing);
    EXPECT_EQ(traced.summary.outcome, session::Outcome::Complete);
    EXPECT_EQ(traced.summary.version, drawn.summary.version);
    EXPECT_EQ(render(view::Renderer::Raster).summary.outcome, session::Outcome::Complete);
}

}  // namespace
}  // namespace tessera::test
