#include "master/render/view_memory.h"

#include <gtest/gtest.h>

#include "master/filter/catalog.h"
#include "master/render/view_request.h"

namespace tessera::master {
namespace {

session::ViewRequest request(const char* filter, std::int32_t width = 640, std::int32_t height = 400) {
    session::ViewRequest request;
    request.view.window = {0, 0, width, height};
    request.view.channels = {frame::Channel::Radiance};
    request.view.filter = filter;
    request.stop.uniform = true;
    complete(request.view);
    return request;
}

std::uint64_t bytes(std::initializer_list<session::ViewRequest> requests) {
    ViewMemory views;
    for (const session::ViewRequest& each : requests) views.add(each);
    return views.bytes();
}

double bytes_per_pixel(std::string_view filter) {
    return std::ranges::find(filter::catalog(), filter,
                             [](const auto& entry) { return entry.description.name; })
        ->description.bytes_per_pixel;
}

constexpr double Pixels = 640 * 400;

TEST(ViewMemory, IsThatOfTheFilmWithoutADenoiser) {
    EXPECT_EQ(bytes({}), 0u);
    EXPECT_EQ(bytes({request("")}), film_bytes(request("").view));
    EXPECT_EQ(bytes({request("none"), request("")}), 2 * film_bytes(request("").view));
}

TEST(ViewMemory, ViewsOfOneSizeShareADenoiserThatKeepsNothing) {
    const std::uint64_t film = film_bytes(request("fdf").view);
    const double denoiser = Pixels * bytes_per_pixel("fdf");
    EXPECT_GT(denoiser, 0.0);
    EXPECT_EQ(double(bytes({request("fdf")})), double(film) + denoiser);
    EXPECT_EQ(double(bytes({request("fdf"), request("fdf:radius=4")})), 2.0 * double(film) + denoiser);
    EXPECT_EQ(double(bytes({request("fdf"), request("fdf", 400, 640)})), 2.0 * double(film) + 2.0 * denoiser);
}

TEST(ViewMemory, DecisionsOfAdaptiveViewsReadACopyOfTheirFilm) {
    session::ViewRequest adaptive = request("none");
    adaptive.stop = {.spp = 1024, .noise = 0.1};
    complete(adaptive);
    EXPECT_EQ(double(bytes({adaptive})), 2.0 * double(film_bytes(adaptive.view)) + 76.0 * Pixels);
    // One after another.
    EXPECT_EQ(double(bytes({adaptive, adaptive})), 3.0 * double(film_bytes(adaptive.view)) + 76.0 * Pixels);
    // That of an error also makes the pictures of both halves.
    session::ViewRequest error = request("fdf");
    error.stop = {.spp = 1024, .error = 0.1};
    complete(error);
    const std::uint64_t film = film_bytes(error.view);
    const double denoiser = Pixels * bytes_per_pixel("fdf");
    EXPECT_GT(double(bytes({error})), 2.0 * double(film) + 2.0 * denoiser + 300.0 * Pixels);
    EXPECT_LT(double(bytes({error})), 2.0 * double(film) + 2.0 * denoiser + 500.0 * Pixels);
    session::ViewRequest live = request("none");
    live.stop = {.spp = 64};
    complete(live);
    EXPECT_EQ(bytes({live}), bytes({adaptive}))
        << "views that are shown while they are rendered have steps, too";
    live.view.renderer = view::Renderer::Raster;
    complete(live);
    EXPECT_EQ(bytes({live}), film_bytes(live.view));
    EXPECT_GT(film_bytes(adaptive.view), film_bytes(request("none").view)) << "it has the variance of blocks";
}

TEST(ViewMemory, CoarsePicturesHaveHistoriesOfTheirOwn) {
    session::ViewRequest live = request("psvgf");
    const double film = double(film_bytes(live.view)), one = Pixels * bytes_per_pixel("psvgf");
    const double all = one * (1.0 + 1.0 / 4 + 1.0 / 16 + 1.0 / 64);
    EXPECT_EQ(double(bytes({live})), film + all);
    EXPECT_EQ(double(bytes({live, live})), 2.0 * (film + all)) << "each view its own";
    live.frames = session::Frames::Last;
    EXPECT_EQ(double(bytes({live})), film + one);
}

}  // namespace
}  // namespace tessera::master
