// Each view has its own filter with its history.
#include "master/render/reconstruction.h"

#include <gtest/gtest.h>

#include "master/render/view_request.h"
#include "mediator/base/random.h"

namespace tessera::master {
namespace {

constexpr std::uint32_t Edge = 32;
constexpr Version Scene{1, 1};

view::View psvgf_view(std::uint64_t id, std::uint64_t revision) {
    view::View view{.id = ViewId{id}, .revision = revision};
    view.width = view.height = Edge;
    view.window = {0, 0, Edge, Edge};
    view.camera = view::perspective(glm::dmat4(1.0), 0.8, 1.0);
    view.channels = {frame::Channel::Radiance};
    view.filter = "psvgf";
    complete(view);
    return view;
}

// Noise on a wall in front of the camera, every pixel with 2 samples.
frame::FilmTile noise(const view::View& view, std::uint64_t seed) {
    frame::FilmTile film(view.window, {0, 1}, view.channels);
    std::fill(film.counts.begin(), film.counts.end(), 2u);
    std::uint32_t state = static_cast<std::uint32_t>(seed) * 2654435761u + 1u;
    for (float& value : film.planes) {
        state = state * 1664525u + 1013904223u;
        value = static_cast<float>(state >> 8) * 0x1p-24f;
    }
    const auto fill = [&](frame::Channel channel, std::uint32_t plane, float value) {
        const auto values = film.plane(film.channels.first_plane(channel) + plane);
        std::fill(values.begin(), values.end(), value);
    };
    fill(frame::Channel::Depth, 0, 2.0f);
    fill(frame::Channel::ObjectIndex, 0, 0.0f);
    fill(frame::Channel::ObjectIndex, 1, 1.0f);  // one object everywhere
    for (const auto& [plane, value] : {std::pair{0u, 0.0f}, {1u, 0.0f}, {2u, 1.0f}})
        fill(frame::Channel::Normal, plane, value);
    return film;
}

std::vector<std::byte> picture(Reconstructor& reconstructor, const view::View& view, std::uint64_t seed,
                               const SceneState& scene = {Scene, {}}) {
    const frame::FilmTile film = noise(view, seed);
    const Reconstruction made = reconstructor.reconstruct(
        {.film = film}, view, scene,
        {.encoding = session::PictureEncoding::Planes, .transform = {}, .view = {}});
    EXPECT_EQ(made.error, "");
    return *made.bytes;
}

TEST(Reconstructor, TemporalFilterKeepsHistoryPerView) {
    Reconstructor fresh, used;
    const auto alone = picture(fresh, psvgf_view(8, 2), 2);
    (void)picture(used, psvgf_view(8, 1), 1);
    EXPECT_NE(picture(used, psvgf_view(8, 2), 2), alone) << "the picture before is history";
}

// The history is doubted after an edit of light or shape that came since the previous picture, also when the picture in
// between was never made; not after others.
TEST(Reconstructor, EditsSinceThePreviousPictureMakeHistoryDoubtful) {
    const auto second = [](Version first, const SceneState& scene) {
        Reconstructor reconstructor;
        (void)picture(reconstructor, psvgf_view(8, 1), 1, {first, {}});
        return picture(reconstructor, psvgf_view(8, 2), 2, scene);
    };
    const Version v1{1, 1}, v2{1, 2}, v3{1, 3};
    const auto trusted = second(v1, {v1, {}});
    EXPECT_EQ(second(v1, {v2, {}}), trusted) << "a name or a camera";
    EXPECT_EQ(second(v2, {v3, {.lights_or_materials = v2, .geometry = v1}}), trusted) << "before it";
    const auto doubted = second(v1, {v2, {.lights_or_materials = v2, .geometry = {}}});
    EXPECT_NE(doubted, trusted);
    EXPECT_EQ(second(v1, {v3, {.lights_or_materials = v2, .geometry = {}}}), doubted);
}

TEST(Reconstructor, ViewsAreIndependent) {
    Reconstructor fresh, used;
    const auto alone = picture(fresh, psvgf_view(16, 2), 2);
    (void)picture(used, psvgf_view(8, 1), 1);
    EXPECT_EQ(picture(used, psvgf_view(16, 2), 2), alone);
}

TEST(Reconstructor, ContinuedFilmIsNotHistory) {
    Reconstructor fresh, used;
    const auto alone = picture(fresh, psvgf_view(8, 1), 2);
    (void)picture(used, psvgf_view(8, 1), 1);
    EXPECT_EQ(picture(used, psvgf_view(8, 1), 2), alone) << "the same revision: more samples, no more";
}

TEST(Reconstructor, ForgottenViewsStartOver) {
    Reconstructor fresh, used;
    const auto alone = picture(fresh, psvgf_view(8, 2), 2);
    (void)picture(used, psvgf_view(8, 1), 1);
    used.forget(ViewId{8}, ViewId{16});
    EXPECT_EQ(picture(used, psvgf_view(8, 2), 2), alone);
}

TEST(Reconstructor, ViewsOfOneSizeShareAFilterThatKeepsNothing) {
    Reconstructor reconstructor;
    const auto show = [&](std::uint64_t id, const char* filter) {
        view::View view = psvgf_view(id, 1);
        view.filter = filter;
        complete(view);
        return picture(reconstructor, view, 1);
    };
    EXPECT_EQ(show(8, "fdf"), show(16, "fdf:radius=8"));
    EXPECT_EQ(reconstructor.filter_count(), 1u);
    show(8, "gauss");
    EXPECT_EQ(reconstructor.filter_count(), 2u) << "the other view still uses fdf";
    reconstructor.forget(ViewId{16}, ViewId{24});
    EXPECT_EQ(reconstructor.filter_count(), 1u);
    show(16, "psvgf");
    show(24, "psvgf");
    show(32, "pixel:schedule=on");
    show(40, "pixel:schedule=on");
    EXPECT_EQ(reconstructor.filter_count(), 5u) << "one for each view";
    reconstructor.forget(ViewId{1}, ViewId{100});
    EXPECT_EQ(reconstructor.filter_count(), 0u);
}

// Schwenk 3.3.3. Pictures of two views alternate, so each needs what it kept.
TEST(Reconstructor, ThePixelFilterRunsItsPassAt4And8And16SamplesOnly) {
    Reconstructor reconstructor;
    for (std::uint32_t n = 1; n <= 20; ++n) {
        for (const std::uint64_t id : {8u, 16u}) {
            view::View view = psvgf_view(id, 1);
            view.filter = "pixel:schedule=on";
            complete(view);
            frame::FilmTile film = noise(view, 1);
            std::fill(film.counts.begin(), film.counts.end(), n);
            const Reconstruction made = reconstructor.reconstruct(
                {.film = film}, view, {Scene, {}},
                {.encoding = session::PictureEncoding::Planes, .transform = {}, .view = {}});
            const bool has_pass = std::ranges::any_of(made.summary.passes,
                                                      [](const auto& pass) { return pass.name == "guide"; });
            EXPECT_EQ(has_pass, n == 4 || n == 8 || n == 16) << n << " samples, view " << id;
        }
    }
}

// Otherwise brightness would fluctuate during edits and between coarse pictures.
TEST(Reconstructor, AllPicturesOfAViewUseTheFirstExposure) {
    Reconstructor reconstructor;
    const auto exposure = [&](ViewId of, float light, std::optional<double> asked = {}) {
        view::View view = psvgf_view(8, 1);
        view.filter = "none";
        frame::FilmTile film = noise(view, 1);
        for (std::uint32_t c = 0; c < 3; ++c) {
            const auto values = film.plane(film.channels.first_plane(frame::Channel::Radiance) + c);
            std::fill(values.begin(), values.end(), light);
        }
        const Reconstruction made =
            reconstructor.reconstruct({.film = film}, view, {Scene, {}},
                                      {.encoding = session::PictureEncoding::Png,
                                       .transform = {view::ViewTransform::Neutral, asked},
                                       .view = of});
        EXPECT_EQ(made.error, "");
        return made.summary.display_transform.exposure;
    };
    EXPECT_FALSE(exposure(ViewId{16}, 0.0f)) << "nothing is lit yet";
    EXPECT_NEAR(exposure(ViewId{16}, 0.36f).value(), -1.0, 1e-5);
    EXPECT_NEAR(exposure(ViewId{16}, 18.0f).value(), -1.0, 1e-5);
    EXPECT_EQ(exposure(ViewId{16}, 18.0f, 2.0).value(), 2.0);
    EXPECT_NEAR(exposure(ViewId{32}, 0.72f).value(), -2.0, 1e-5);
    reconstructor.forget(ViewId{16}, ViewId{32});
    EXPECT_NEAR(exposure(ViewId{16}, 0.18f).value(), 0.0, 1e-5);
    EXPECT_NEAR(exposure(ViewId{32}, 0.18f).value(), -2.0, 1e-5);
}

}  // namespace
}  // namespace tessera::master
