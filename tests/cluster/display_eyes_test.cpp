// Displays: the eyes and the layers of an output.
#include "mediator/backend/catalog.h"
#include "mediator/scene/fields.h"
#include "tests/cluster/display_fixture.h"

namespace tessera::test {
namespace {

using namespace scene;

TEST_F(Displays, BothEyesHaveTheSameSamplesAndCamerasASeparationApart) {
    cluster.add_node("null");
    wall.outputs[0].stereo = display::Stereo::SideBySide;
    wall.outputs.pop_back();
    ann->open_display(wall);
    Shower& left = show("left");
    until([&] { return all_show(4); });
    const auto& pictures = left.frames.back().pictures;
    ASSERT_EQ(pictures.size(), 2u);
    EXPECT_EQ(pictures[0].eye, view::Eye::Left);
    EXPECT_EQ(pictures[1].eye, view::Eye::Right);
    const auto apart = pictures[1].camera.world_from_camera[3] - pictures[0].camera.world_from_camera[3];
    EXPECT_NEAR(apart.x, wall.eye_separation, 1e-12);
    ann->adjust_display({.eye_separation = 0.5});
    const std::size_t before = left.frames.size();
    until([&] {
        return left.frames.size() > before && all_show(4) &&
               left.frames.back().pictures[1].camera.world_from_camera[3][0] > 0.2;
    });
}

// A filter with a large radius, an eye that looks into light and one that looks into the dark.
TEST_F(Displays, FiltersNeverBleedAcrossEyesAndOutputs) {
    cluster.add_node("null");
    wall.filter = "bilateral";
    wall.outputs[0].stereo = display::Stereo::SideBySide;
    ann->open_display(wall);
    Shower& both = show("left");
    until([&] { return all_show(4); });
    const client::OutputFrame together = both.frames.back();
    // Each eye alone, as an output of its own: the same bytes.
    for (const auto& [stereo, eye] :
         {std::pair(display::Stereo::Left, 0), std::pair(display::Stereo::Right, 1)}) {
        wall.outputs[0].stereo = stereo;
        const std::size_t before = both.frames.size();
        ann->open_display(wall);
        until([&] {
            return both.frames.size() > before && all_show(4) && both.frames.back().pictures.size() == 1;
        });
        EXPECT_TRUE(both.frames.back().pictures[0].bytes == together.pictures[std::size_t(eye)].bytes)
            << "eye " << eye;
    }
}

TEST_F(Displays, TheDifferenceOfTheEyesIsReported) {
    cluster.add_node("embree");
    wall.outputs[0].stereo = display::Stereo::TopBottom;
    wall.outputs.pop_back();
    wall.stereo_difference = true;
    ann->open_display(wall);
    show("left");
    until([&] { return all_show(4); });
    const double difference = status().display.outputs[0].stereo_difference;
    EXPECT_GE(difference, 0.0);
    EXPECT_LT(difference, 1.0);
}

// Path tracing with a layer of another renderer over it; both can be switched off while it runs.
TEST_F(Displays, LayersAreSwitchedAtRunTime) {
    cluster.add_node("embree");
    Transform gui;
    gui.layers = 2;
    submit({Update{first, Fields<Transform>(Transform::Field::Layers).bits(), gui}});
    wall.outputs.pop_back();
    wall.layers = {{"model", view::Renderer::PathTracing, 1, true},
                   {"gui", view::Renderer::Whitted, 2, true}};
    ann->open_display(wall);
    Shower& left = show("left");
    until([&] { return all_show(4); });
    const std::vector<std::byte> with_gui = left.frames.back().pictures[0].bytes;
    const auto switched = [&](std::uint32_t shown) {
        const std::size_t before = left.frames.size();
        ann->adjust_display({.shown_layers = shown});
        until([&] { return left.frames.size() > before && all_show(4); });
        return left.frames.back().pictures[0].bytes;
    };
    EXPECT_TRUE(switched(1) != with_gui) << "the model alone";
    EXPECT_TRUE(switched(3) == with_gui) << "back again, to the bit";
}

// One back-end, so one scene, for both eyes and all outputs.
TEST_F(Displays, OneSceneCopyForAllEyes) {
    std::atomic<int> made = 0;
    cluster.add_node([&](const backend::BackendSettings& settings) {
        ++made;
        return backend::find_backend("embree").make(settings);
    });
    for (display::Output& output : wall.outputs) output.stereo = display::Stereo::TopBottom;
    ann->open_display(wall);
    show("left");
    show("right");
    until([&] { return all_show(4); });
    EXPECT_EQ(made, 1);
    EXPECT_EQ(showers["left"].frames.back().pictures.size(), 2u);
}

}  // namespace
}  // namespace tessera::test
