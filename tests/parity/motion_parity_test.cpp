// Both back-ends agree on moving scenes, sample by sample.
#include <cmath>
#include <cstdio>
#include <functional>

#include "mediator/backend/catalog.h"
#include "mediator/frame/resolve.h"
#include "tests/statistics/scene_model.h"

namespace tessera::test {
namespace {

constexpr std::uint32_t Size = 48, Level = 2;

struct Shot {
    std::unique_ptr<backend::Backend> backend;
    frame::Image film(const view::View& view, std::uint64_t sample, frame::Channel channel) const {
        const view::WorkUnit unit{
            .version = backend->version(), .tile = view.window, .block = {sample << Level, Level}};
        backend::RenderResult result = backend->render(view, unit, {});
        EXPECT_EQ(result.status, backend::RenderStatus::Done);
        return resolve(result.blocks.at(0), channel);
    }
};

Shot shot(const std::string& name, SceneModel& model) {
    Shot made{backend::find_backend(name).make({.blobs = model.blobs()})};
    const auto edit = made.backend->begin_edit();
    EXPECT_TRUE(edit->apply(scene::snapshot(model.finished())));
    const auto report = edit->commit();
    EXPECT_TRUE(report);
    if (report) {
        EXPECT_TRUE(report->problems.empty()) << report->problems.front();
    }
    return made;
}

glm::dmat4 moved(const glm::dvec3& way) {
    return glm::translate(glm::dmat4(1.0), way);
}
glm::dmat4 turned(double angle, const glm::dvec3& axis) {
    return glm::rotate(glm::dmat4(1.0), angle, axis);
}

using Corners = std::array<glm::vec3, 4>;
Corners square(float edge, const glm::vec3& place, const glm::vec3& offset = glm::vec3(0.0f)) {
    return {{place + glm::vec3(-edge, -edge, 0), place + glm::vec3(edge, -edge, 0),
             place + glm::vec3(edge, edge, 0) + offset, place + glm::vec3(-edge, edge, 0)}};
}

// A floor; a ball, a lamp and a screen that move independently; a moving light.
void put(SceneModel& model, const glm::dmat4& frame) {
    model.set_frame(frame);
    const ObjectId grey = model.material(chalk(glm::vec3(0.6f)));
    model.floor(grey, 3.0f, 0.0f);
    const glm::dmat4 back = glm::inverse(frame);
    model.moves({frame * moved({0.4, 0, 0.2}) * back,
                 frame * moved({0.5, 0.5, 0.2}) * turned(0.3, {0, 0, 1}) * back});
    model.sphere(grey, {-0.8, 0.0, 0.6}, 0.5, Normals::Smooth, 12);
    model.moves({frame * turned(0.5, {0, 1, 0}) * back});
    model.deforming_quad(model.material(lamp(5.0f)),
                         {square(0.5f, {0.5f, 0, 2}), square(0.3f, {0.2f, 0, 2.2f}, {0.2f, 0, -0.4f})});
    model.moves({});
    model.deforming_quad(grey, {square(0.4f, {0.8f, 0.2f, 0.9f}), square(0.4f, {0.6f, 0.2f, 0.8f}),
                                square(0.5f, {0.3f, -0.4f, 0.9f})});
    model.moves({frame * moved({2.0, 0, 0}) * back});
    model.light({.kind = scene::LightKind::Sphere, .intensity = glm::vec3(1.0f), .radius = 0.2f},
                moved({-1, -1.5, 1.2}));
    model.sky(glm::vec3(0.2f));
}

view::View view_of(const glm::dmat4& frame) {
    view::View view = small_view({0.2, -4.5, 2.5}, 0.8, Size, turned(1.1, {1.0, 0.0, 0.0}));
    view.id = ViewId{1};
    view.max_bounces = 4;
    view.channels = {frame::Channel::Radiance, frame::Channel::Depth};
    view.camera.world_from_camera = frame * view.camera.world_from_camera;
    view.camera.motion = {frame * moved({0.1, 0.1, 0}) * glm::inverse(frame) * view.camera.world_from_camera};
    return view;
}

// For a few samples: the fraction of pixels that differ, and whether the means agree.
void expect_same(SceneModel& ours, SceneModel& theirs, const view::View& view, double share) {
    const Shot vulkan = shot("vulkan", ours), embree = shot("embree", theirs);
    double sum = 0.0, squares = 0.0, count = 0.0, others = 0.0, light = 0.0;
    for (std::uint64_t sample = 0; sample < 4; ++sample) {
        const frame::Image a = vulkan.film(view, sample, frame::Channel::Radiance),
                           b = embree.film(view, sample, frame::Channel::Radiance);
        for (std::size_t i = 0; i < a.values.size(); i += 3, ++count) {
            const double d = double(a.values[i]) - double(b.values[i]);
            sum += d;
            squares += d * d;
            light += double(b.values[i]);
            others += std::fabs(d) <= 1e-3 * std::max(1.0, double(b.values[i])) ? 0.0 : 1.0;
        }
    }
    std::printf("of %g pixels %g are others, mean %.3g, difference %.2g\n", count, others, light / count,
                sum / count);
    EXPECT_GT(light / count, 0.05);
    EXPECT_LE(others / count, share);
    EXPECT_LE(std::fabs(sum / count), 3.0 * std::sqrt(squares) / count + 6e-8 * light / count);
}

TEST(MotionParity, SampleBySample) {
    SceneModel ours, theirs;
    put(ours, glm::dmat4(1.0));
    put(theirs, glm::dmat4(1.0));
    expect_same(ours, theirs, view_of(glm::dmat4(1.0)), 0.005);
}

TEST(MotionParity, MirroredAndStretched) {
    const glm::dmat4 frame = glm::scale(turned(0.5, {1, 2, 3}), {-1.0, 1.0, 1.0});
    SceneModel ours, theirs;
    put(ours, frame);
    put(theirs, frame);
    expect_same(ours, theirs, view_of(frame), 0.005);
}

// Floats have a resolution of 1e-4 m at 1 km, which moves edges.
TEST(MotionParity, FarAway) {
    const glm::dmat4 frame = moved({1000.0, -300.0, 200.0});
    SceneModel ours, theirs;
    put(ours, frame);
    put(theirs, frame);
    expect_same(ours, theirs, view_of(frame), 0.05);
}

// The same without deforming meshes, and by the renderer of perfect speculars.
TEST(MotionParity, ByWhitted) {
    SceneModel ours, theirs;
    put(ours, glm::dmat4(1.0));
    put(theirs, glm::dmat4(1.0));
    view::View view = view_of(glm::dmat4(1.0));
    view.renderer = view::Renderer::Whitted;
    expect_same(ours, theirs, view, 0.005);
}

}  // namespace
}  // namespace tessera::test
