// Nodes whose device runs out of memory.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "mediator/backend/catalog.h"
#include "mediator/scene/fields.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using namespace scene;
using namespace std::chrono_literals;

// Wraps a back-end and fails with OutOfMemory above a number of lights.
class LimitedMemoryBackend final : public backend::Backend {
  public:
    LimitedMemoryBackend(std::unique_ptr<Backend> inner, std::size_t capacity)
        : inner_(std::move(inner)), capacity_(capacity) {}

    backend::Capabilities capabilities() const override { return inner_->capabilities(); }
    Version version() const override { return inner_->version(); }
    std::unique_ptr<backend::EditScope> begin_edit() override { return std::make_unique<Edit>(*this); }
    backend::RenderResult render(const view::View& view, const view::WorkUnit& unit,
                                 std::stop_token stop) override {
        return inner_->render(view, unit, stop);
    }
    std::vector<std::string> probe(const view::View& view, std::uint32_t x, std::uint32_t y,
                                   std::uint64_t sample) override {
        return inner_->probe(view, x, y, sample);
    }

  private:
    class Edit final : public backend::EditScope {
      public:
        explicit Edit(LimitedMemoryBackend& owner)
            : owner_(owner), inner_(owner.inner_->begin_edit()), lamps_(owner.lamps_) {}
        Expected<void> apply(const ChangeList& changes, const Scene& after) override {
            if (changes.from.number == 0) lamps_.clear();
            for (const Entry& entry : changes.entries) {
                const auto* create = std::get_if<Create>(&entry);
                if (create && std::holds_alternative<Light>(create->object)) lamps_.push_back(create->id);
                if (std::holds_alternative<Remove>(entry)) std::erase(lamps_, id(entry));
            }
            return inner_->apply(changes, after);
        }
        const Scene& scene() const override { return inner_->scene(); }
        Expected<backend::EditReport> commit() override {
            if (lamps_.size() > owner_.capacity_) {
                return failure(ErrorCode::OutOfMemory, "capacity for " + std::to_string(owner_.capacity_) +
                                                           " lamps, not for " +
                                                           std::to_string(lamps_.size()));
            }
            owner_.lamps_ = lamps_;
            return inner_->commit();
        }

      private:
        LimitedMemoryBackend& owner_;
        std::unique_ptr<backend::EditScope> inner_;
        std::vector<ObjectId> lamps_;
    };

    std::unique_ptr<Backend> inner_;
    std::size_t capacity_;
    std::vector<ObjectId> lamps_;
};

LoopbackCluster::MakeBackend with_room(std::size_t lamps) {
    return [lamps](const backend::BackendSettings& settings) {
        return std::make_unique<LimitedMemoryBackend>(backend::find_backend("null").make(settings), lamps);
    };
}

struct DeviceMemoryTest : testing::Test {
    client::ViewResult render() {
        session::ViewRequest request{.stop = {.spp = 2}, .min_nodes = 1, .film = true};
        request.view.width = request.view.height = 40;
        request.view.window = {0, 0, 40, 40};
        request.view.channels = {frame::Channel::Radiance};
        request.wait_limit = 500ms;
        return client::render(*session, request, {}, {});
    }
    void open() {
        session = cluster.session(blobs);
        const auto opened = session->join({.title = "test", .exclusive = true}, {});
        first = std::get<client::Joined>(opened).first_id;
        submit(scene_entries(first, *blobs));
    }
    void submit(std::vector<Entry> entries) {
        const auto done = session->submit(std::move(entries));
        ASSERT_TRUE(done.accepted);
    }
    ObjectId lamp(std::uint64_t number) const { return ObjectId{first.value + 100 + number}; }
    bool was_logged(const std::string& text) const {
        const std::vector<std::string> events = cluster.events();
        return std::ranges::any_of(
            events, [&](const std::string& event) { return event.find(text) != std::string::npos; });
    }

    std::shared_ptr<BlobStore> blobs = std::make_shared<BlobStore>();
    LoopbackCluster cluster;
    std::unique_ptr<client::Session> session;
    ObjectId first;
};

TEST_F(DeviceMemoryTest, ANodeOutOfMemoryReportsItAndTakesTheNextVersion) {
    cluster.add_node(with_room(1));
    open();
    submit({Create{lamp(0), Light{}}});
    EXPECT_EQ(render().summary.outcome, session::Outcome::Complete);

    submit({Create{lamp(1), Light{}}});
    const client::ViewResult none = render();
    EXPECT_EQ(none.summary.outcome, session::Outcome::NoNodes);
    EXPECT_NE(
        none.summary.message.find("1 node cannot build the scene (node-1: capacity for 1 lamps, not for 2)"),
        std::string::npos)
        << none.summary.message;
    EXPECT_TRUE(was_logged("cannot build version"));

    submit({Create{lamp(2), Light{}}});  // worse still
    EXPECT_EQ(render().summary.outcome, session::Outcome::NoNodes);
    submit({Remove{lamp(0)}, Remove{lamp(1)}});
    EXPECT_EQ(render().summary.outcome, session::Outcome::Complete);
    EXPECT_FALSE(was_logged("leaves"));
}

TEST_F(DeviceMemoryTest, TheOthersRenderWithoutIt) {
    cluster.add_node(with_room(0));
    cluster.add_node(with_room(9));
    open();
    submit({Create{lamp(0), Light{}}});
    const client::ViewResult result = render();
    EXPECT_EQ(result.summary.outcome, session::Outcome::Complete);
    std::size_t taking_part = 0;
    for (const auto& node : result.summary.nodes) taking_part += node.samples > 0 ? 1 : 0;
    EXPECT_EQ(taking_part, 1u);
}

TEST_F(DeviceMemoryTest, ALiveEditThatNoNodeCanBuildIsUndoneAndItsAuthorNotified) {
    cluster.add_node(with_room(1));
    session = cluster.member("ann", blobs);
    const auto node_is_at = [&](Version version) {
        for (int i = 0; i < 500; ++i) {
            const session::ClusterStatus status = session->status();
            if (status.nodes.size() == 1 && status.nodes[0].version.number >= version.number) return true;
            std::this_thread::sleep_for(10ms);
        }
        return false;
    };
    const ObjectId fits = session->new_id(), too_many = session->new_id();
    const auto first_edit = session->submit({Create{fits, Light{}}});
    ASSERT_TRUE(first_edit.accepted);
    ASSERT_TRUE(node_is_at(first_edit.version));
    const auto second = session->submit({Create{too_many, Light{.name = "lamp"}}});
    ASSERT_TRUE(second.accepted) << "the master does not know the sizes of devices";

    std::vector<std::string> notices;
    for (int i = 0; i < 500 && notices.empty(); ++i) {
        std::this_thread::sleep_for(10ms);
        session->pump();
        notices = session->take_notices();
    }
    ASSERT_EQ(notices.size(), 1u);
    EXPECT_NE(notices[0].find("edit " + std::to_string(second.transaction)), std::string::npos) << notices[0];
    EXPECT_NE(notices[0].find("node-1: capacity for 1 lamps, not for 2"), std::string::npos) << notices[0];
    session->refresh();
    EXPECT_NE(session->scene().find(fits), nullptr);
    EXPECT_EQ(session->scene().find(too_many), nullptr);
    EXPECT_EQ(session->history(1).at(0).undoes, second.transaction);
    EXPECT_TRUE(node_is_at(session->scene().version())) << "the node goes on";
    EXPECT_TRUE(session->submit({Create{session->new_id(), Material{}}}).accepted) << "so does the author";
}

TEST(DeviceMemoryRestart, AnUndoneEditStaysUndone) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("tessera-undone-" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder);
    const auto records = [&](master::MasterSettings& settings) {
        settings.session_folder = folder;
        settings.checkpoint_interval = std::chrono::hours(1);
    };
    ObjectId fits, too_many;
    {
        LoopbackCluster cluster(records);
        cluster.add_node(with_room(1));
        const auto ann = cluster.member("ann", std::make_shared<BlobStore>());
        fits = ann->new_id();
        too_many = ann->new_id();
        ASSERT_TRUE(ann->submit({Create{fits, Light{}}}).accepted);
        ASSERT_TRUE(ann->submit({Create{too_many, Light{.name = "lamp"}}}).accepted);
        for (int i = 0; i < 500 && ann->take_notices().empty(); ++i) {
            std::this_thread::sleep_for(10ms);
            ann->pump();
        }
        ann->refresh();
        ASSERT_EQ(ann->scene().find(too_many), nullptr);
    }
    {
        LoopbackCluster cluster(records);
        cluster.add_node(with_room(1));
        const auto ann = cluster.member("ann", std::make_shared<BlobStore>());
        ann->refresh();
        EXPECT_NE(ann->scene().find(fits), nullptr);
        EXPECT_EQ(ann->scene().find(too_many), nullptr);
        const auto is_built = [&] {
            const session::ClusterStatus status = ann->status();
            return status.nodes.size() == 1 && status.nodes[0].version == status.version;
        };
        for (int i = 0; i < 500 && !is_built(); ++i) std::this_thread::sleep_for(10ms);
        EXPECT_TRUE(is_built());
        for (const std::string& event : cluster.events())
            EXPECT_EQ(event.find("cannot build"), std::string::npos) << event;
    }
    std::filesystem::remove_all(folder);
}

TEST_F(DeviceMemoryTest, TheNextSceneIsSentToItAgain) {
    cluster.add_node(with_room(0));
    open();
    submit({Create{lamp(0), Light{}}});
    EXPECT_EQ(render().summary.outcome, session::Outcome::NoNodes);
    session.reset();
    open();
    EXPECT_EQ(render().summary.outcome, session::Outcome::Complete);
}

}  // namespace
}  // namespace tessera::test
