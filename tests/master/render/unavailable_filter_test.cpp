// A filter that needs a library which the master's machine lacks, or that fails there.
#include <gtest/gtest.h>

#include <algorithm>

#include "master/render/reconstruction.h"
#include "master/render/view_request.h"
#include "tests/support/environment.h"

namespace tessera::master {
namespace {

using test::EnvironmentVariable;

session::ViewRequest filtered_request(const std::string& filter) {
    session::ViewRequest request;
    request.view.channels = {frame::Channel::Radiance};
    request.view.filter = filter;
    request.stop.spp = 1;
    request.picture = session::PictureEncoding::Planes;
    return request;
}

// The library is searched for until it is found, and then kept: this is the first test of it in its process.
TEST(UnavailableFilter, ViewsAreRefusedUntilTheLibraryIsThere) {
    const session::ViewRequest request = filtered_request("oidn");
    {
        const EnvironmentVariable fails("TESSERA_OIDN_FAILS", "device");
        const std::string problem = problem_of(request);
        EXPECT_NE(problem.find("filter 'oidn' needs Open Image Denoise"), std::string::npos) << problem;
        EXPECT_EQ(problem, why_unavailable(request.view));
        EXPECT_EQ(problem_of(filtered_request("fdf")), "");
        EXPECT_EQ(why_unavailable(filtered_request("fdf").view), "");
        EXPECT_EQ(why_unavailable(filtered_request("no filter").view), "");
    }
    EXPECT_EQ(problem_of(request), "");
    EXPECT_EQ(why_unavailable(request.view), "");
}

TEST(UnavailableFilter, ReproducibleFramesAreRefused) {
    session::ViewRequest request = filtered_request("oidn");
    request.reproducible = true;
    EXPECT_NE(problem_of(request).find("does not give the same bits on every machine"), std::string::npos);
    request.view.filter = "fdf";
    EXPECT_EQ(problem_of(request), "");
}

TEST(UnavailableFilter, AFailureIsAnErrorOfThePicture) {
    view::View view{.id = ViewId{8}, .revision = 1};
    view.width = view.height = 16;
    view.window = {0, 0, 16, 16};
    view.camera = view::perspective(glm::dmat4(1.0), 0.8, 1.0);
    view.channels = {frame::Channel::Radiance};
    view.filter = "oidn";
    complete(view);
    frame::FilmTile film(view.window, {0, 1}, view.channels);
    std::fill(film.counts.begin(), film.counts.end(), 2u);
    const auto reconstructed = [&](Reconstructor& reconstructor) {
        return reconstructor.reconstruct(
            {.film = film}, view, {1, 1},
            {.encoding = session::PictureEncoding::Planes, .transform = {}, .view = {}});
    };
    Reconstructor reconstructor;
    {
        const EnvironmentVariable fails("TESSERA_OIDN_FAILS", "execute");
        EXPECT_EQ(reconstructed(reconstructor).error,
                  "the filter oidn failed: Open Image Denoise cannot filter the picture: the network is lost "
                  "(error 1)");
    }
    const Reconstruction picture = reconstructed(reconstructor);
    EXPECT_EQ(picture.error, "");
    EXPECT_EQ(picture.bytes->size(), std::size_t{16} * 16 * 3 * sizeof(float));
}

}  // namespace
}  // namespace tessera::master
