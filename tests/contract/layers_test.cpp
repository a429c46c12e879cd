// Views of some object layers: hidden objects do not exist for any ray or light.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "mediator/backend/catalog.h"
#include "mediator/frame/resolve.h"
#include "tests/contract/contract_scene.h"

namespace tessera::backend {
namespace {

using frame::Channel, frame::FilmTile;
using scene::Create, scene::Entry, scene::Transform;

constexpr ObjectId Ghost{60}, GhostAt{61};

// Sets the layers of these subtrees.
void put(std::vector<Entry>& entries, std::initializer_list<ObjectId> transforms, std::uint32_t layers) {
    for (Entry& entry : entries) {
        auto* create = std::get_if<Create>(&entry);
        const bool is_named =
            create != nullptr && std::ranges::find(transforms, create->id) != transforms.end();
        if (is_named) std::get<Transform>(create->object).layers = layers;
    }
}

struct Layers : testing::TestWithParam<std::string> {
    // The null back-end's values depend on the whole scene, visible or not.
    bool traces() const { return GetParam() != "null"; }

    void show(std::vector<Entry> entries) {
        test::SceneBuilder builder;
        backend = find_backend(GetParam()).make({.threads = 2, .isa = {}, .blobs = blobs});
        test::commit(*backend, {builder.edit(std::move(entries))});
    }
    std::vector<Entry> plain() { return test::contract_scene(*blobs); }
    // In layers 1 and 2; within the bounds of the rest, by which lights that shine on all of it are chosen.
    std::vector<Entry> haunted() {
        std::vector<Entry> entries = plain();
        std::get<scene::Root>(std::get<Create>(entries[0]).object).children.push_back(GhostAt);
        entries.push_back(Create{GhostAt, test::transform(test::moved(0.15, -0.2, -2.1), {Ghost})});
        entries.push_back(Create{Ghost, test::square(*blobs, 0.4f, test::Red)});
        put(entries, {GhostAt}, 6);
        return entries;
    }
    FilmTile film(std::uint32_t layers, view::Renderer renderer, frame::SampleBlock block = {0, 2}) {
        view::View view = test::contract_view(backend->capabilities().channels);
        view.layers = layers;
        view.renderer = renderer;
        const view::WorkUnit unit{.version = backend->version(), .tile = view.window, .block = block};
        RenderResult result = backend->render(view, unit, {});
        EXPECT_EQ(result.status, RenderStatus::Done);
        return std::move(result.blocks.at(0));
    }
    std::vector<view::Renderer> renderers() const {
        std::vector<view::Renderer> all;
        for (const auto one : {view::Renderer::PathTracing, view::Renderer::Whitted, view::Renderer::Raster,
                               view::Renderer::Coverage}) {
            if (backend->capabilities().renderers.contains(one)) all.push_back(one);
        }
        return all;
    }
    std::vector<view::Renderer> lit_renderers() const {
        std::vector<view::Renderer> all = renderers();
        std::erase(all, view::Renderer::Coverage);
        return all;
    }
    static std::size_t pixels_of(const FilmTile& film, ObjectId object) {
        std::size_t count = 0;
        for (const float id : film.plane(film.channels.first_plane(Channel::ObjectIndex) + 1)) {
            count += std::bit_cast<std::uint32_t>(id) == object.value ? 1 : 0;
        }
        return count;
    }

    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    std::unique_ptr<Backend> backend;
};

TEST_P(Layers, AViewSeesOnlyItsLayers) {
    show(haunted());
    for (const view::Renderer renderer : renderers()) {
        SCOPED_TRACE(view::renderer_name(renderer));
        for (const std::uint32_t layers : {view::AllLayers, 2u, 4u, 3u}) {
            EXPECT_GT(pixels_of(film(layers, renderer), Ghost), 100u) << layers;
        }
        for (const std::uint32_t layers : {0u, 1u, 8u}) {
            EXPECT_EQ(pixels_of(film(layers, renderer), Ghost), 0u) << layers;
        }
        EXPECT_GT(pixels_of(film(1, renderer), test::Floor), 100u);
        EXPECT_EQ(pixels_of(film(2, renderer), test::Floor), 0u);
        EXPECT_EQ(pixels_of(film(0, renderer), test::Floor), 0u);
    }
}

TEST_P(Layers, HiddenObjectsAffectNoChannel) {
    if (!traces()) return;
    show(plain());
    const auto all = renderers();
    std::vector<FilmTile> without;
    for (const view::Renderer renderer : all) without.push_back(film(view::AllLayers, renderer));
    show(haunted());
    for (std::size_t i = 0; i < all.size(); ++i) {
        SCOPED_TRACE(view::renderer_name(all[i]));
        EXPECT_TRUE(frame::identical_bits(film(1, all[i]), without[i]));
        EXPECT_FALSE(frame::identical_bits(film(3, all[i]), without[i]));
    }
}

TEST_P(Layers, OneLayerForAllGivesTheSameBitsAsNone) {
    if (!traces()) return;
    show(plain());
    const FilmTile expected = film(view::AllLayers, view::Renderer::PathTracing);
    std::vector<Entry> entries = plain();
    put(entries, {test::FloorAt, test::BlockAt, test::BlockAlsoAt, test::LampAt}, 0x80000000);
    show(std::move(entries));
    EXPECT_TRUE(frame::identical_bits(film(0x80000000, view::Renderer::PathTracing), expected));
    EXPECT_TRUE(frame::identical_bits(film(view::AllLayers, view::Renderer::PathTracing), expected));
}

// The mean light of the picture and the variance of that mean.
struct Mean {
    double value = 0.0, variance = 0.0;
};
Mean mean_light(const FilmTile& film) {
    const frame::Image light = frame::resolve(film, Channel::Radiance),
                       variance = frame::resolve_variance_of_mean(film, Channel::Radiance);
    Mean mean;
    const double n = static_cast<double>(light.values.size());
    for (const float value : light.values) mean.value += value / n;
    for (const float value : variance.values) mean.variance += value / (n * n);
    return mean;
}

// A lamp and an emissive square are hidden; the choice among lights still knows them, so samples are lost to
// them and the bits are others. Components of a pixel go together, which the factor 3 of the variance allows
// for.
TEST_P(Layers, HiddenObjectsEmitNothing) {
    if (!traces()) return;
    constexpr frame::SampleBlock Many{0, 6};
    std::vector<Entry> without = plain();
    std::get<scene::Root>(std::get<Create>(without[0]).object).children = {test::FloorAt, test::BlockAlsoAt};
    show(without);
    const auto all = lit_renderers();
    std::vector<Mean> expected;
    for (const view::Renderer one : all) expected.push_back(mean_light(film(view::AllLayers, one, Many)));
    std::vector<Entry> with = plain();
    put(with, {test::BlockAt, test::LampAt}, 2);
    show(with);
    for (std::size_t i = 0; i < all.size(); ++i) {
        SCOPED_TRACE(view::renderer_name(all[i]));
        const Mean hidden = mean_light(film(1, all[i], Many)), shown = mean_light(film(3, all[i], Many));
        const double error = std::sqrt(3.0 * (hidden.variance + expected[i].variance));
        EXPECT_LE(std::fabs(hidden.value - expected[i].value), 4.0 * error);
        EXPECT_LE(error, 0.01 * expected[i].value) << "this test would see little";
        EXPECT_GT(shown.value, 1.5 * hidden.value) << "the hidden objects emit much of the light";
    }
}

TEST_P(Layers, WithoutAnyLightItIsBlackToTheBit) {
    if (!traces()) return;
    std::vector<Entry> dark = plain();
    std::get<scene::Root>(std::get<Create>(dark[0]).object).background = {};
    put(dark, {test::BlockAt, test::BlockAlsoAt, test::LampAt}, 2);
    show(dark);
    for (const view::Renderer renderer : lit_renderers()) {
        const FilmTile film_of_floor = film(1, renderer);
        EXPECT_GT(pixels_of(film_of_floor, test::Floor), 100u);
        for (const float value : frame::resolve(film_of_floor, Channel::Radiance).values)
            ASSERT_EQ(value, 0.0f);
    }
}

TEST_P(Layers, AProbeSeesWhatTheViewSees) {
    if (!traces()) return;
    show(haunted());
    view::View view = test::contract_view(backend->capabilities().channels);
    const auto path_log = [&](std::uint32_t layers) {
        view.layers = layers;
        std::string text;
        for (const std::string& line : backend->probe(view, 26, 16, 0)) text += line + "\n";
        return text;
    };
    EXPECT_NE(path_log(3).find(std::to_string(Ghost.value)), std::string::npos) << path_log(3);
    EXPECT_NE(path_log(1), path_log(3));
}

std::vector<std::string> layered_backends() {
    std::vector<std::string> result;
    for (const BackendEntry& entry : catalog()) result.push_back(entry.name);
    return result;
}
INSTANTIATE_TEST_SUITE_P(Catalog, Layers, testing::ValuesIn(layered_backends()),
                         [](const auto& entry) { return entry.param; });

}  // namespace
}  // namespace tessera::backend
