// Incremental == rebuilt, for every back-end and for the ShadowScene that they share.
#include "tests/contract/random_edits.h"

#include <gtest/gtest.h>

#include "mediator/backend/catalog.h"
#include "mediator/backend/shadow_scene.h"

namespace tessera::backend {
namespace {

void expect_equal(const FlatScene& a, const FlatScene& b, int step) {
    ASSERT_EQ(a.instances.size(), b.instances.size()) << "step " << step;
    for (std::size_t i = 0; i < a.instances.size(); ++i) {
        ASSERT_EQ(a.instances[i].geometry, b.instances[i].geometry) << "step " << step;
        ASSERT_EQ(a.instances[i].path, b.instances[i].path) << "step " << step;
        ASSERT_EQ(a.instances[i].hint, b.instances[i].hint) << "step " << step;
        ASSERT_EQ(a.instances[i].layers, b.instances[i].layers) << "step " << step;
        ASSERT_EQ(a.instances[i].world_from_object, b.instances[i].world_from_object) << "step " << step;
    }
    ASSERT_EQ(a.lights.size(), b.lights.size()) << "step " << step;
    for (std::size_t i = 0; i < a.lights.size(); ++i) {
        ASSERT_EQ(a.lights[i].light, b.lights[i].light) << "step " << step;
        ASSERT_EQ(a.lights[i].path, b.lights[i].path) << "step " << step;
        ASSERT_EQ(a.lights[i].layers, b.lights[i].layers) << "step " << step;
        ASSERT_EQ(a.lights[i].world_from_light, b.lights[i].world_from_light) << "step " << step;
    }
}

TEST(ShadowSceneAtRandom, EqualsARebuiltOneAfterEveryEditAndEveryRollback) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        scene::BlobStore blobs;
        test::RandomEdits edits(seed, blobs);
        ShadowScene shadow;
        ASSERT_TRUE(shadow.apply(edits.start()));
        shadow.take_delta();
        std::vector<scene::ChangeList> since;  // the last delta
        for (int step = 0; step < 400; ++step) {
            since.push_back(edits.next());
            ASSERT_TRUE(shadow.apply(since.back()));
            ShadowScene rebuilt;
            ASSERT_TRUE(rebuilt.apply(snapshot(edits.scene())));
            expect_equal(shadow.flat_scene(), rebuilt.flat_scene(), step);
            if (step % 7 == 6) {  // undone and redone
                shadow.rollback();
                for (const scene::ChangeList& list : since)
                    ASSERT_TRUE(shadow.apply(list)) << "step " << step;
                expect_equal(shadow.flat_scene(), rebuilt.flat_scene(), step);
                EXPECT_EQ(shadow.scene().state_hash(), edits.scene().state_hash());
            }
            if (step % 3 == 0) {
                shadow.take_delta();
                since.clear();
            }
        }
    }
}

// What the delta says, applied to a table of instances by hand, is the new table.
TEST(ShadowSceneAtRandom, TheDeltaHasEverythingThatMoved) {
    scene::BlobStore blobs;
    test::RandomEdits edits(4, blobs);
    ShadowScene shadow;
    ASSERT_TRUE(shadow.apply(edits.start()));
    shadow.take_delta();
    FlatScene known = shadow.flat_scene();
    for (int step = 0; step < 300; ++step) {
        for (int i = 0; i <= step % 3; ++i) ASSERT_TRUE(shadow.apply(edits.next()));
        const SceneDelta delta = shadow.take_delta();
        if (delta.instances_changed) known.instances = shadow.flat_scene().instances;
        for (const std::uint32_t i : delta.moved_instances)
            known.instances.at(i) = shadow.flat_scene().instances.at(i);
        if (delta.lights_changed) known.lights = shadow.flat_scene().lights;
        expect_equal(known, shadow.flat_scene(), step);
    }
}

struct EditedBackend : testing::TestWithParam<std::string> {};

TEST_P(EditedBackend, RendersTheSameBitsAsOneThatWasBuiltAnew) {
    const std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    const auto make = [&] {
        return find_backend(GetParam()).make({.threads = 2, .isa = {}, .blobs = blobs});
    };
    const auto picture = [](Backend& backend, int step) {
        view::View view = test::contract_view(backend.capabilities().channels);
        if (step % 8 == 0) view.layers = 3;
        const view::WorkUnit unit{.id = UnitId{1},
                                  .view = view.id,
                                  .revision = view.revision,
                                  .version = backend.version(),
                                  .tile = view.window,
                                  .block = {0, 1}};
        return backend.render(view, unit, {});
    };
    // A software device compiles a kernel, for seconds, for each set of features that comes up.
    const int steps = GetParam() == "vulkan" ? 40 : 200;
    for (const std::uint64_t seed : {5u, 6u}) {
        test::RandomEdits edits(seed, *blobs);
        const auto edited = make();
        test::commit(*edited, {edits.start()});
        for (int step = 0; step < steps; ++step) {
            std::vector<scene::ChangeList> lists;
            for (int i = 0; i <= step % 3; ++i) lists.push_back(edits.next());
            test::commit(*edited, lists);
            if (step % 4 != 0) continue;
            const auto rebuilt = make();
            test::commit(*rebuilt, {snapshot(edits.scene())});
            const RenderResult a = picture(*edited, step), b = picture(*rebuilt, step);
            ASSERT_EQ(a.status, RenderStatus::Done);
            ASSERT_TRUE(frame::identical_bits(a.blocks.at(0), b.blocks.at(0)))
                << "seed " << seed << " step " << step;
        }
    }
}

std::vector<std::string> edited_backends() {
    std::vector<std::string> result;
    for (const BackendEntry& entry : catalog()) result.push_back(entry.name);
    return result;
}

INSTANTIATE_TEST_SUITE_P(Catalog, EditedBackend, testing::ValuesIn(edited_backends()),
                         [](const auto& entry) { return entry.param; });

}  // namespace
}  // namespace tessera::backend
