#include "mediator/picture/stereo_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace tessera::picture {
namespace {

constexpr std::uint32_t Width = 160, Height = 90;

// A plane `distance` in front, painted with a pattern that depends on the place in the world alone.
struct Painted {
    std::vector<float> red, green, blue, depth;
    view::CameraPose camera;

    Painted(double x, double distance, double scale = 1.0) {
        camera = view::perspective(glm::dmat4(1.0), 0.9, double(Width) / Height);
        camera.world_from_camera[3][0] = x;
        for (std::uint32_t row = 0; row < Height; ++row) {
            for (std::uint32_t column = 0; column < Width; ++column) {
                const double u = camera.left + (camera.right - camera.left) * (column + 0.5) / Width;
                const double v = camera.top + (camera.bottom - camera.top) * (row + 0.5) / Height;
                const double value =
                    1.0 + 0.5 * std::sin(2.0 * (x + u * distance) / scale) * std::cos(v * distance / scale);
                for (auto* plane : {&red, &green, &blue}) plane->push_back(static_cast<float>(value));
                depth.push_back(static_cast<float>(distance));
            }
        }
    }
    EyeView view() const { return {Width, Height, red, green, blue, depth, camera}; }
};

TEST(StereoDifference, EyesThatSeeTheSameSurfaceAgree) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
        const Painted left(-0.03 * scale, 2.0 * scale, scale), right(0.03 * scale, 2.0 * scale, scale);
        const StereoDifference difference = stereo_difference(left.view(), right.view());
        EXPECT_LT(difference.mean, 2e-3) << "only what bilinear reading costs, at scale " << scale;
        EXPECT_GT(difference.shared, 0.9);
        EXPECT_LT(difference.shared, 1.0) << "an edge of the left picture is beyond the right one";
    }
}

TEST(StereoDifference, DetectsNoiseAndABrighterEye) {
    const Painted left(-0.03, 2.0);
    Painted right(0.03, 2.0);
    for (auto* plane : {&right.red, &right.green, &right.blue}) {
        for (float& value : *plane) value *= 1.5f;
    }
    EXPECT_NEAR(stereo_difference(left.view(), right.view()).mean, 0.2, 0.01);  // 0.5 / 2.5
}

TEST(StereoDifference, IgnoresWhatOnlyOneEyeSees) {
    const Painted left(-0.03, 2.0);
    Painted right(0.03, 2.0);
    // Something near hides the right half from the right eye.
    for (std::size_t i = 0; i < right.depth.size(); ++i) {
        if (i % Width < Width / 2) continue;
        right.depth[i] = 0.5f;
        right.red[i] = right.green[i] = right.blue[i] = 100.0f;
    }
    const StereoDifference difference = stereo_difference(left.view(), right.view());
    EXPECT_LT(difference.mean, 2e-3);
    EXPECT_NEAR(difference.shared, 0.5, 0.05);
}

TEST(StereoDifference, IsZeroWithNothingToCompare) {
    Painted left(-0.03, 2.0), right(0.03, 2.0);
    for (float& depth : left.depth) depth = std::numeric_limits<float>::infinity();
    EXPECT_EQ(stereo_difference(left.view(), right.view()).mean, 0.0);
    Painted black(-0.03, 2.0);
    for (auto* plane : {&black.red, &black.green, &black.blue}) plane->assign(plane->size(), 0.0f);
    const StereoDifference dark = stereo_difference(black.view(), black.view());
    EXPECT_EQ(dark.mean, 0.0);
    EXPECT_GT(dark.shared, 0.9);
}

}  // namespace
}  // namespace tessera::picture
