// The Vulkan and Embree back-ends agree sample by sample, in the benchmark scenes without caustics.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <utility>

#include "mediator/frame/merge.h"
#include "mediator/frame/resolve.h"
#include "mediator/picture/metrics.h"
#include "mediator/scene/fields.h"
#include "tests/parity/both.h"
#include "tests/parity/jittered.h"

namespace tessera::test {
namespace {

using frame::Channel, frame::FilmTile, frame::Image;

constexpr std::uint32_t Size = 64, Spp = 16;
constexpr float Tolerance = 1e-3f;  // of a value, absolute up to 1

bool agree(float a, float b) {
    return a == b || std::fabs(a - b) <= Tolerance * std::max(1.0f, std::fabs(b));
}

// Number of pixels in which any component of any channel differs.
std::uint64_t disagreements(const FilmTile& film, const FilmTile& reference) {
    std::vector<bool> differs(film.pixel_count());
    for (const frame::ChannelInfo& info : frame::channel_table()) {
        if (!film.channels.contains(info.channel)) continue;
        const Image ours = resolve(film, info.channel), theirs = resolve(reference, info.channel);
        for (std::size_t i = 0; i < ours.values.size(); ++i) {
            if (!agree(ours.values[i], theirs.values[i])) differs[i / ours.components] = true;
        }
    }
    return static_cast<std::uint64_t>(std::count(differs.begin(), differs.end(), true));
}

// The mean of the differences of paired values and its standard error.
struct PairedMean {
    double sum = 0.0, squares = 0.0, count = 0.0;
    double size = 0.0;  // sum of the values' own

    void add(const Image& ours, const Image& theirs) {
        for (std::size_t i = 0; i < ours.values.size(); ++i) {
            const double d = double(ours.values[i]) - double(theirs.values[i]);
            sum += d;
            squares += d * d;
            size += std::fabs(double(theirs.values[i]));
            ++count;
        }
    }
    double mean() const { return sum / count; }
    // Bound of the mean's error by the rounding of the values, half an ulp each.
    double rounding() const { return 6e-8 * size / count; }
    double error() const { return std::sqrt(squares - sum * sum / count) / count; }
};

// Samples of two pictures of a scene that differ from the Embree back-end's.
struct Counts {
    std::uint64_t vulkan = 0, control = 0;
};

// `factors`: of a path's light that the back-ends may round differently, each alike in all paths.
Counts measure(const std::string& name, const tools::bench::BenchScene& scene, const view::View& view,
               double factors = 1.0) {
    SCOPED_TRACE(name);
    const Renderer embree("embree", scene), vulkan("vulkan", scene);
    const JitteredEmbree jittered(scene);
    Counts counts;
    PairedMean difference;
    for (std::uint64_t sample = 0; sample < Spp; ++sample) {
        const FilmTile expected = embree.film(view, view.window, {sample, 0});
        const FilmTile found = vulkan.film(view, view.window, {sample, 0});
        counts.vulkan += disagreements(found, expected);
        counts.control += disagreements(jittered.film(view, view.window, sample), expected);
        if (sample == 0) {
            EXPECT_LE(counts.vulkan, 0.005 * Size * Size) << "of the pixels at one sample";
        }
        difference.add(resolve(found, Channel::Radiance), resolve(expected, Channel::Radiance));
    }
    EXPECT_LE(std::fabs(difference.mean()), 3.0 * difference.error() + factors * difference.rounding());
    const FilmTile found = vulkan.film(view, view.window, {0, 4}),
                   expected = embree.film(view, view.window, {0, 4});
    const double relmse =
        picture::relmse(resolve(found, Channel::Radiance), resolve(expected, Channel::Radiance));
    EXPECT_LE(relmse, 1e-4);
    std::printf("%s: of %u samples %u are others (control: %u), mean %.2g +- %.2g, relMSE %.2g\n",
                name.c_str(), Size * Size * Spp, unsigned(counts.vulkan), unsigned(counts.control),
                difference.mean(), difference.error(), relmse);
    return counts;
}

Counts measure_scene(const std::string& name) {
    const tools::bench::BenchScene scene = bench_scene(name);
    return measure(name, scene, square_view(scene, Size));
}

// One test, since few samples differ: the ratio to the control is that of all scenes.
TEST(Parity, SampleBySample) {
    Counts all;
    for (const char* name : {"cornell", "grids", "room-1", "studio-1"}) {
        const Counts counts = measure_scene(name);
        all.vulkan += counts.vulkan;
        all.control += counts.control;
    }
    EXPECT_GE(all.control, 5u) << "the control says little";
    EXPECT_LE(all.vulkan, 3 * all.control);
}

// Every third transform is in a layer that the view does not see: one of the two lights, and a ball.
TEST(Parity, WhereLayersAreHidden) {
    tools::bench::BenchScene scene = bench_scene("studio-1");
    std::vector<scene::Entry> entries;
    std::size_t transforms = 0;
    for (const auto& [id, object] : scene.content.objects()) {
        if (!std::holds_alternative<scene::Transform>(*object) || transforms++ % 3 != 2) continue;
        entries.push_back(scene::Update{id, scene::Fields<scene::Transform>(&scene::Transform::layers).bits(),
                                        scene::Transform{.layers = 2}});
    }
    ASSERT_TRUE(scene.content.apply_entries(entries));
    view::View view = square_view(scene, Size);
    view.layers = 1;
    const Counts counts = measure("studio-1 with layers", scene, view);
    EXPECT_GE(counts.control, 1u) << "the control says little";
    EXPECT_LE(counts.vulkan, 3 * counts.control);
}

// Connections to the light pass two tinted panes and an unlit sheet under the ceiling, and a pane in front of a block.
TEST(Parity, ThroughPanesAndAnUnlitSheet) {
    tools::bench::BenchScene scene = bench_scene("cornell");
    const auto blob = [&](const auto& values) {
        scene.blobs.push_back(std::make_shared<scene::Blob>(std::as_bytes(std::span(values))));
        return scene::reference(*scene.blobs.back());
    };
    scene::Root root = *scene.content.find_as<scene::Root>(scene::RootId);
    std::vector<scene::Entry> entries;
    ObjectId next{1000};
    const auto add = [&](scene::Object object) {
        entries.push_back(scene::Create{next, std::move(object)});
        return std::exchange(next, ObjectId{next.value + 1});
    };
    const ObjectId glass = add(scene::Material{.base_color = {0.9f, 0.8f, 0.7f, 1.0f},
                                               .roughness = 0.0f,
                                               .double_sided = true,
                                               .transmission = 1.0f});
    const ObjectId unlit =
        add(scene::Material{.base_color = {0.2f, 0.5f, 0.9f, 1.0f}, .double_sided = true, .unlit = true});
    const auto sheet = [&](ObjectId material, const std::array<glm::vec3, 4>& corners) {
        root.children.push_back(
            add(scene::Geometry{.material = material,
                                .indices = blob(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}),
                                .positions = blob(std::vector<glm::vec3>(corners.begin(), corners.end()))}));
    };
    sheet(glass, {{{-0.9f, 1.7f, -0.9f}, {0.9f, 1.7f, -0.9f}, {0.9f, 1.7f, 0.9f}, {-0.9f, 1.7f, 0.9f}}});
    sheet(glass, {{{-0.5f, 1.5f, -0.5f}, {0.9f, 1.6f, -0.5f}, {0.9f, 1.6f, 0.9f}, {-0.5f, 1.5f, 0.9f}}});
    sheet(glass, {{{-0.9f, 0.1f, 0.8f}, {0.2f, 0.1f, 0.8f}, {0.2f, 1.3f, 0.8f}, {-0.9f, 1.3f, 0.8f}}});
    sheet(unlit, {{{-0.8f, 1.3f, -0.9f}, {0.7f, 1.3f, -0.9f}, {0.7f, 1.4f, 0.5f}, {-0.8f, 1.4f, 0.5f}}});
    entries.push_back(
        scene::Update{scene::RootId, scene::Fields<scene::Root>(&scene::Root::children).bits(), root});
    ASSERT_TRUE(scene.content.apply_entries(entries));
    constexpr double ValueAndPanes = 1.0 + 2.0;
    const Counts counts =
        measure("cornell with panes and an unlit sheet", scene, square_view(scene, Size), ValueAndPanes);
    EXPECT_LE(counts.vulkan, 3 * counts.control + 3);
}

TEST(Parity, ThroughALensAndWithParallelRays) {
    const tools::bench::BenchScene scene = bench_scene("room-1");
    Counts all;
    for (const auto projection : {scene::Projection::Perspective, scene::Projection::Orthographic}) {
        view::View view = square_view(scene, Size);
        const bool parallel = projection == scene::Projection::Orthographic;
        view.camera =
            view::pose({.projection = projection,
                        .orthographic_height = 4.0,
                        .lens_radius = 0.05,
                        .focus_distance = 3.0,
                        .aperture = parallel ? scene::Aperture::Gaussian : scene::Aperture::Uniform},
                       scene.camera.world_from_camera, 1.0);
        const Counts counts = measure(parallel ? "room-1, parallel" : "room-1, lens", scene, view);
        all.vulkan += counts.vulkan;
        all.control += counts.control;
    }
    EXPECT_GE(all.control, 1u) << "the control says little";
    EXPECT_LE(all.vulkan, 3 * all.control);
}

}  // namespace
}  // namespace tessera::test
