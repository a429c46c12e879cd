// The exposure of rendered pictures, encoded by the client or the master.
#include "client/tools/pictures.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tessera::tools {
namespace {

client::ViewResult lit(float radiance) {
    client::ViewResult result;
    result.frame.film.emplace(Rect{0, 0, 4, 4}, frame::SampleBlock{},
                              frame::ChannelSet{frame::Channel::Radiance});
    frame::FilmTile& film = *result.frame.film;
    std::ranges::fill(film.counts, 1u);
    for (std::uint32_t c = 0; c < 3; ++c)
        std::ranges::fill(film.plane(film.channels.first_plane(frame::Channel::Radiance) + c), radiance);
    return result;
}

TEST(UsedTransform, IsMeasuredOnTheFirstNonBlackPicture) {
    const session::ViewRequest request;
    EXPECT_FALSE(used_transform({"a.png"}, request, lit(0.0f)).exposure) << "a sequence may fade in";
    EXPECT_NEAR(used_transform({"a.exr", "a.png"}, request, lit(0.72f)).exposure.value(), -2.0, 1e-5);
    EXPECT_FALSE(used_transform({"a.exr"}, request, lit(0.72f)).exposure) << "linear light needs none";
}

TEST(UsedTransform, KeepsTheRequestedExposure) {
    session::ViewRequest request;
    request.display_transform = {view::ViewTransform::Agx, 1.5};
    EXPECT_EQ(used_transform({"a.png"}, request, lit(0.72f)), request.display_transform);
}

TEST(UsedTransform, IsTheMastersIfItEncodedThePicture) {
    client::ViewResult result = lit(0.72f);
    result.frame.picture.resize(8);
    result.frame.encoding = session::PictureEncoding::Png;
    result.summary.picture.display_transform = {view::ViewTransform::Neutral, 3.25};
    EXPECT_EQ(used_transform({"a.png"}, session::ViewRequest{}, result).exposure.value(), 3.25);
}

}  // namespace
}  // namespace tessera::tools
