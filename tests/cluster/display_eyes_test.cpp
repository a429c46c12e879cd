// Displays: the eyes and the layers of an output.
#include <array>

#include "mediator/backend/catalog.h"
#include "mediator/scene/fields.h"
#include "tests/cluster/display_fixture.h"

namespace tessera::test {
namespace {

using namespace scene;
using namespace std::chrono_literals;

TEST_F(Displays, BothEyesHaveTheSameSamplesAndCamerasASeparationApart) {
    cluster.add_node("null");
    wall.outputs[0].stereo = display::Stereo::SideBySide;
    wall.outputs.pop_back();
    ann->open_display(wall);
    OutputClient& left = show("left");
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
    OutputClient& both = show("left");
    until([&] { return all_show(4); });
    const client::OutputFrame together = both.frames.back();
    // Each eye as a separate output: the same bytes.
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
    submit({Update{first, Fields<Transform>(&Transform::layers).bits(), gui}});
    wall.outputs.pop_back();
    wall.layers = {{"model", view::Renderer::PathTracing, 1, true},
                   {"gui", view::Renderer::Whitted, 2, true}};
    ann->open_display(wall);
    OutputClient& left = show("left");
    until([&] { return all_show(4); });
    const std::vector<std::byte> with_gui = left.frames.back().pictures[0].bytes;
    const auto switched = [&](std::uint32_t shown) {
        const std::size_t before = left.frames.size();
        ann->adjust_display({.shown_layers = shown});
        until([&] { return left.frames.size() > before && all_show(4); });
        return left.frames.back().pictures[0].bytes;
    };
    EXPECT_TRUE(switched(1) != with_gui) << "the model alone";
    EXPECT_TRUE(switched(3) == with_gui) << "the same bits again";
}

// Light of one colour over the part of the picture from `left` to `right` of it, -1 to 1, at a distance.
std::vector<Entry> shining_quad(client::Session& editor, BlobStore& blobs, const glm::vec3& light, float left,
                                float right, float distance, ObjectId& quad) {
    const std::array<glm::vec3, 4> corners{
        glm::vec3(left * distance, -distance, -distance), glm::vec3(right * distance, -distance, -distance),
        glm::vec3(right * distance, distance, -distance), glm::vec3(left * distance, distance, -distance)};
    constexpr std::array<std::uint32_t, 6> Triangles{0, 1, 2, 0, 2, 3};
    const ObjectId material = editor.new_id();
    quad = editor.new_id();
    return {Create{material, Material{.base_color = {0, 0, 0, 1}, .emission = light}},
            Create{quad, Geometry{.material = material,
                                  .indices = reference(*blobs.insert(std::as_bytes(std::span(Triangles)))),
                                  .positions = reference(*blobs.insert(std::as_bytes(std::span(corners))))}}};
}

// The later layer is partly in front of the first and partly behind it.
TEST_F(Displays, LayersAreComposedByDepth) {
    cluster.add_node("embree");
    const ObjectId model = ann->new_id(), gui = ann->new_id();
    ObjectId red, green, blue;
    for (const auto& entries : {shining_quad(*ann, *blobs, {1, 0, 0}, -2, 2, 3, red),
                                shining_quad(*ann, *blobs, {0, 1, 0}, -2, 0, 1, green),
                                shining_quad(*ann, *blobs, {0, 0, 1}, 0, 2, 5, blue)})
        submit(entries);
    submit(
        {Create{model, Transform{.children = {red}, .layers = 1}},
         Create{gui, Transform{.children = {green, blue}, .layers = 2}},
         Update{RootId, Fields<Root>(&Root::children).bits(), Root{.children = {place_id(), model, gui}}}});
    wall.outputs = {part_of_wall("left", -1, 1)};
    wall.layers = {{"model", view::Renderer::PathTracing, 1, true},
                   {"gui", view::Renderer::PathTracing, 2, true}};
    ann->open_display(wall);
    OutputClient& left = show("left");
    until([&] { return all_show(4); });
    const auto pixel = [&](std::size_t x) {
        std::array<int, 3> rgb{};
        for (std::size_t c = 0; c < 3; ++c)
            rgb[c] = std::to_integer<int>(left.frames.back().pictures[0].bytes.at(3 * (24 * 64 + x) + c));
        return rgb;
    };
    EXPECT_EQ(pixel(16), (std::array{0, 255, 0})) << "the menu is in front";
    EXPECT_EQ(pixel(48), (std::array{255, 0, 0})) << "the menu is behind";
}

// A pass renders the layers that were shown when it began, whatever is requested meanwhile.
TEST_F(Displays, LayersMaySwitchFasterThanPicturesAreRendered) {
    cluster.add_node("null", {}, 20us);
    wall.layers = {{"model", view::Renderer::PathTracing, 1, true},
                   {"gui", view::Renderer::PathTracing, 2, false}};
    wall.outputs[0].stereo = display::Stereo::SideBySide;
    ann->open_display(wall);
    show("left");
    show("right");
    for (const std::uint32_t shown : {3u, 1u, 3u, 2u, 3u, 1u, 2u, 3u, 1u, 3u}) {
        for (const std::uint32_t again : {shown, 3u, 1u, shown}) ann->adjust_display({.shown_layers = again});
        const std::size_t before = output_clients["left"].frames.size();
        until([&] { return output_clients["left"].frames.size() > before; });
    }
    until([&] { return all_show(4); });
    EXPECT_EQ(status().display.outputs.at(0).state, session::OutputState::Locked);
}

TEST_F(Displays, MonoHasNoEyeDifference) {
    cluster.add_node("embree");
    wall.outputs[1].stereo = display::Stereo::Left;
    wall.stereo_difference = true;
    ann->open_display(wall);
    show("left");
    show("right");
    until([&] { return all_show(4); });
    for (const std::string& event : cluster.events())
        EXPECT_EQ(event.find("is skipped"), std::string::npos) << event;
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
    EXPECT_EQ(output_clients["left"].frames.back().pictures.size(), 2u);
}

}  // namespace
}  // namespace tessera::test
