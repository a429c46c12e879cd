// Everything that the back-end does with a device, under the validation layers, without messages.
#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>

#include "backends/vulkan/vulkan_backend.h"
#include "tests/contract/contract_scene.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {
namespace {

using namespace backend;

constexpr frame::ChannelSet AllChannels = frame::ChannelSet::all();

class ValidatedBackend : public testing::Test {
  protected:
    ValidatedBackend() {
        changes = builder.edit(test::contract_scene(*blobs));
        view = test::contract_view(AllChannels);
    }
    ~ValidatedBackend() override {
        backend.reset();
        const std::scoped_lock lock(mutex_);
        for (const Message& message : messages_) {
            ADD_FAILURE() << "validation: " << message.id << "\n" << message.text;
        }
    }

    void open(DeviceSettings settings = {}) {
        settings.validation = wanted_validation();
        settings.buffer_slack = slack_for(settings.validation);
        settings.listener = [this](const Message& message) {
            const std::scoped_lock lock(mutex_);
            messages_.push_back(message);
        };
        backend = make_backend({.blobs = blobs}, settings);
        test::commit(*backend, {changes});
    }
    // Renders four samples of the picture; returns the rays.
    std::uint64_t rays_of(view::Renderer renderer = view::Renderer::PathTracing) {
        view.renderer = renderer;
        const view::WorkUnit unit{.id = UnitId{1},
                                  .view = view.id,
                                  .revision = view.revision,
                                  .version = backend->version(),
                                  .tile = view.window,
                                  .block = {0, 2}};
        const RenderResult result = backend->render(view, unit, {});
        EXPECT_EQ(result.status, RenderStatus::Done);
        return result.rays;
    }

    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    test::SceneBuilder builder;
    scene::ChangeList changes;
    view::View view;
    std::unique_ptr<Backend> backend;

  private:
    std::mutex mutex_;
    std::vector<Message> messages_;
};

TEST_F(ValidatedBackend, AllRenderersAndAllKindsOfEditsAreValid) {
    std::vector mappings{MemorySettings::Mapping::Default};
    // Mapping only affects copies; kernels, which are slow to compile with instrumentation, are the same.
    if (wanted_validation() != Validation::Instrumented)
        mappings.push_back(MemorySettings::Mapping::Separate);
    for (const auto mapping : mappings) {
        builder = {};
        changes = builder.edit(test::contract_scene(*blobs));
        open({.memory = {.mapping = mapping}});
        EXPECT_GT(rays_of(), 0u);
        EXPECT_GT(rays_of(view::Renderer::Whitted),
                  0u);  // by the same kernel, since the headlight feature is requested
        test::commit(*backend, {builder.move(test::BlockAt, test::moved(0.2, 0.1, -1.5))});  // retransformed
        EXPECT_GT(rays_of(), 0u);
        test::commit(*backend,
                     {builder.edit({test::SceneBuilder::update<scene::Geometry>(
                         test::Block, &scene::Geometry::hint, {.hint = scene::MotionHint::Animated})})});
        scene::Geometry deformed = test::square(*blobs, 0.3f, test::Emissive);
        deformed.positions = test::array_blob<float>(
            *blobs, {-0.3f, -0.3f, 0, 0.3f, -0.3f, 0.1f, 0.3f, 0.3f, 0, -0.3f, 0.3f, 0});
        {
            const auto scope = backend->begin_edit();
            ASSERT_TRUE(scope->apply(builder.edit({test::SceneBuilder::update<scene::Geometry>(
                test::Block, &scene::Geometry::positions, deformed)})));
            EXPECT_EQ(scope->commit().value().refitted, 1u);
        }
        EXPECT_GT(rays_of(), 0u);
        test::commit(*backend, {builder.edit({scene::Remove{test::Floor}})});
        EXPECT_GT(rays_of(), 0u);
        EXPECT_FALSE(backend->probe(view, 24, 16, 0).empty());
    }
}

}  // namespace
}  // namespace tessera::vulkan
