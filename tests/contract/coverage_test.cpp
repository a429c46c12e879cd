// The renderer `coverage`: visible objects and their parts of the picture.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <map>

#include "mediator/backend/catalog.h"
#include "mediator/backend/tables/view_record.h"
#include "mediator/frame/resolve.h"
#include "mediator/shading/trace.h"
#include "tests/contract/contract_scene.h"

namespace tessera::backend {
namespace {

using frame::Channel;
using Counts = std::map<std::uint32_t, int>;

struct Square {
    glm::dvec3 center;
    float size = 0.0f;  // half an edge
    float alpha = 1.0f;
};
constexpr std::uint32_t First = 100;  // id of the first square

// For any view: 64 x 64 pixels, metres from -1 to 1 at distance 1.
view::View view_of(scene::Projection projection) {
    view::View view;
    view.id = ViewId{1};
    view.width = view.height = 64;
    view.window = {0, 0, 64, 64};
    view.seed = 3;
    view.camera.projection = projection;
    view.renderer = view::Renderer::Coverage;
    view.channels = {Channel::Color, Channel::ObjectIndex};
    return view;
}

struct CoverageRenderer : testing::TestWithParam<std::string> {
    void show(const std::vector<Square>& squares) {
        scene::Root root;
        std::vector<scene::Entry> entries{scene::Create{scene::RootId, root}};
        for (std::uint32_t i = 0; i < squares.size(); ++i) {
            const ObjectId place{200 + i}, paint{300 + i};
            const scene::Material material{.base_color = {0.5f, 0.5f, 0.5f, squares[i].alpha},
                                           .emission = glm::vec3(i % 2 == 0 ? 0.0f : 5.0f),
                                           .alpha_mode = scene::AlphaMode::Blend};
            entries.push_back(scene::Create{paint, material});
            entries.push_back(
                scene::Create{ObjectId{First + i}, test::square(*blobs, squares[i].size, paint)});
            const glm::dvec3& at = squares[i].center;
            entries.push_back(
                scene::Create{place, test::transform(test::moved(at.x, at.y, at.z), {ObjectId{First + i}})});
            root.children.push_back(place);
        }
        std::get<scene::Create>(entries[0]).object = root;
        test::SceneBuilder builder;
        backend = find_backend(GetParam()).make({.threads = 2, .isa = {}, .blobs = blobs});
        test::commit(*backend, {builder.edit(std::move(entries))});
    }
    frame::FilmTile film(const view::View& view, frame::SampleBlock block = {0, 0}) {
        const view::WorkUnit unit{.version = backend->version(), .tile = view.window, .block = block};
        RenderResult result = backend->render(view, unit, {});
        EXPECT_EQ(result.status, RenderStatus::Done);
        return std::move(result.blocks.at(0));
    }
    static Counts counts(const frame::FilmTile& film) {
        Counts seen;
        for (const float id : film.plane(film.channels.first_plane(Channel::ObjectIndex) + 1))
            ++seen[std::bit_cast<std::uint32_t>(id)];
        return seen;
    }

    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    std::unique_ptr<Backend> backend;
};

// Edges of squares are pixel edges, so that no sample may be wrong.
TEST_P(CoverageRenderer, CountsVisibleObjects) {
    const view::View view = view_of(scene::Projection::Orthographic);
    show({{{0.0, 0.0, -3.0}, 0.5f}});
    EXPECT_EQ(counts(film(view)), (Counts{{0, 3072}, {First, 1024}}));
    // Half of it behind the second; the third is behind both; the fourth behind the camera.
    show({{{0.0, 0.0, -3.0}, 0.5f},
          {{0.5, 0.0, -2.0}, 0.5f},
          {{0.125, 0.0, -4.0}, 0.25f},
          {{0.0, 0.0, 2.0}, 0.5f}});
    EXPECT_EQ(counts(film(view)), (Counts{{0, 2560}, {First, 512}, {First + 1, 1024}}));
}

TEST_P(CoverageRenderer, SeesThroughAlphaStochastically) {
    show({{{0.0, 0.0, -3.0}, 1.0f}, {{0.0, 0.0, -2.0}, 0.5f, 0.25f}});
    const Counts seen = counts(film(view_of(scene::Projection::Orthographic)));
    // 1024 samples, each is stopped with probability 1/4: 4 standard deviations.
    EXPECT_NEAR(seen.at(First + 1), 256, 4.0 * std::sqrt(1024 * 0.25 * 0.75));
    EXPECT_EQ(seen.at(First) + seen.at(First + 1), 4096);
}

// Unlit: emissive squares have a colour like others, and the background is black.
TEST_P(CoverageRenderer, ShowsEachObjectInItsColor) {
    show({{{-0.5, 0.0, -3.0}, 0.25f}, {{0.5, 0.0, -3.0}, 0.25f}});
    const frame::FilmTile seen = film(view_of(scene::Projection::Orthographic), {0, 2});
    const frame::Image colors = frame::resolve_picture(seen);
    const auto at = [&](std::size_t x, std::size_t y) {
        const auto rgb = colors.pixel(64 * y + x);
        return glm::vec3(rgb[0], rgb[1], rgb[2]);
    };
    for (const std::uint32_t i : {0u, 1u}) {
        const glm::vec3 difference = at(16 + 32 * i, 32) - shading::object_color(First + i);
        EXPECT_LE(glm::length(difference), 1e-6f) << i;
    }
    EXPECT_GT(glm::length(at(16, 32) - at(48, 32)), 0.05f);
    EXPECT_EQ(at(32, 32), glm::vec3(0.0f));
}

// For each sample the nearest square on its ray, computed analytically.
Counts brute_force(const view::View& view, const std::vector<Square>& squares) {
    const shading::View record = make_view(view, glm::dvec3(0.0));
    Counts seen;
    for (std::uint32_t y = 0; y < view.height; ++y) {
        for (std::uint32_t x = 0; x < view.width; ++x) {
            const shading::Sampler numbers = shading::make_sampler(x, y, view.seed, 0);
            const shading::Ray ray =
                shading::camera_ray(record, x, y, shading::sample_pair(numbers, shading::CameraSet),
                                    shading::sample_pair(numbers, shading::LensSet));
            const glm::dvec3 origin(ray.origin), direction(ray.direction);
            double nearest = 1e30;
            std::uint32_t object = 0;
            for (std::uint32_t i = 0; i < squares.size(); ++i) {
                const double t = (squares[i].center.z - origin.z) / direction.z;
                const glm::dvec3 off = origin + t * direction - squares[i].center;
                const double size = double(squares[i].size);
                if (!(t > 0.0 && t < nearest) || std::fabs(off.x) > size || std::fabs(off.y) > size) continue;
                nearest = t;
                object = First + i;
            }
            ++seen[object];
        }
    }
    return seen;
}

// The other channels: depth along the view axis, also for oblique rays, and alpha.
TEST_P(CoverageRenderer, HasDepthAndAlpha) {
    view::View view = view_of(scene::Projection::Perspective);
    view.channels = {Channel::Depth, Channel::Alpha};
    show({{{-1.0, 0.0, -2.0}, 0.75f}, {{1.0, 0.0, -4.0}, 0.75f}});
    const frame::FilmTile seen = film(view);
    const frame::Image depths = frame::resolve(seen, Channel::Depth),
                       alphas = frame::resolve(seen, Channel::Alpha);
    Counts hits, expected = brute_force(view, {{{-1.0, 0.0, -2.0}, 0.75f}, {{1.0, 0.0, -4.0}, 0.75f}});
    for (std::size_t i = 0; i < depths.values.size(); ++i) {
        const float depth = depths.values[i];
        const bool is_near = std::abs(depth - 2.0f) <= 1e-5f, is_far = std::abs(depth - 4.0f) <= 1e-5f;
        EXPECT_TRUE(is_near || is_far || depth == std::numeric_limits<float>::infinity())
            << i << ": " << depth;
        EXPECT_EQ(alphas.values[i], is_near || is_far ? 1.0f : 0.0f) << i << ": " << depth;
        ++hits[is_near ? First : is_far ? First + 1 : 0];
    }
    for (const auto& [object, count] : expected) EXPECT_NEAR(hits[object], count, 2) << object;
}

// T37. A sample on an edge may go to either side: one in 2000.
TEST_P(CoverageRenderer, CountsAsBruteForceDoesThroughAnyLens) {
    std::vector<Square> squares;
    for (int i = 0; i < 10; ++i) {
        const double angle = 0.9 * i, depth = 2.0 + 0.35 * i;
        squares.push_back({{0.8 * std::cos(angle), 0.8 * std::sin(1.7 * angle), -depth},
                           0.15f + 0.07f * static_cast<float>(i)});
    }
    squares.push_back({{0.0, 0.0, -9.0}, 1e-3f});  // behind others
    show(squares);
    view::View view = view_of(scene::Projection::Perspective);
    for (const double lens : {0.0, 0.2}) {
        view.camera.lens_radius = lens;
        view.camera.focus_distance = 3.0;
        const Counts expected = brute_force(view, squares), seen = counts(film(view));
        ASSERT_GE(expected.size(), 9u);
        EXPECT_EQ(expected.count(First + 10), 0u);
        EXPECT_EQ(seen.size(), expected.size());
        for (const auto& [object, count] : expected)
            EXPECT_NEAR(seen.count(object) ? seen.at(object) : 0, count, 2) << object << ' ' << lens;
    }
}

std::vector<std::string> tracing() {
    std::vector<std::string> result;
    for (const BackendEntry& entry : catalog()) {
        if (std::string(entry.name) != "null") result.push_back(entry.name);
    }
    return result;
}
INSTANTIATE_TEST_SUITE_P(Catalog, CoverageRenderer, testing::ValuesIn(tracing()),
                         [](const auto& entry) { return entry.param; });

}  // namespace
}  // namespace tessera::backend
