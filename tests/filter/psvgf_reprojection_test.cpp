// Progressive SVGF while camera and surfaces move: history follows its surfaces.
#include <gtest/gtest.h>

#include <cmath>

#include "mediator/base/random.h"
#include "tests/filter/psvgf_session.h"

namespace tessera::filter {
namespace {

// Intersection over union of two masks, where the first one is the same for two pixels around: in between
// a bilinear tap may see both sides.
double overlap(const std::vector<bool>& truth, const std::vector<bool>& found, std::uint32_t width) {
    const auto height = static_cast<std::int64_t>(truth.size() / width);
    double both = 0.0, any = 0.0;
    for (std::int64_t y = 2; y + 2 < height; ++y) {
        for (std::int64_t x = 2; x + 2 < width; ++x) {
            const auto i = static_cast<std::size_t>(y * width + x);
            bool uniform = true;
            for (std::int64_t dy = -2; dy <= 2; ++dy) {
                for (std::int64_t dx = -2; dx <= 2; ++dx) {
                    uniform &= truth[i] == truth[static_cast<std::size_t>((y + dy) * width + x + dx)];
                }
            }
            if (!uniform) continue;
            both += truth[i] && found[i] ? 1.0 : 0.0;
            any += truth[i] || found[i] ? 1.0 : 0.0;
        }
    }
    return any > 0.0 ? both / any : 1.0;
}

struct Move {
    glm::dvec3 shift;
    double yaw;
};

class PsvgfMove : public testing::TestWithParam<Move> {};

TEST_P(PsvgfMove, HistoryFollowsTheSurfaces) {  // DT6
    const std::uint32_t width = 192, height = 128;
    PlanesScene scene;
    scene.tilt = 0.2;
    const auto from = looking_at(scene, {}, width, height);
    const auto to = looking_at(scene, GetParam().shift, width, height, GetParam().yaw);
    Session session(Raw + "r0=0");
    // Irradiance that is a texture of the wall, known exactly.
    const auto picture_of = [&](const view::CameraPose& camera, std::uint64_t n) {
        Inputs inputs = photograph(scene, camera, {.width = width, .height = height, .noise = false});
        std::ranges::fill(inputs.counts.values(), float(n));
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                const auto hit = scene.trace(camera, width, height, x + 0.5, y + 0.5);
                const auto value =
                    static_cast<float>(1.0 + 0.5 * std::sin(2.0 * hit->point.x + hit->point.y));
                for (std::uint32_t c = 0; c < 3; ++c) {
                    inputs.means[std::size_t(frame::Channel::Irradiance)].row(c, y)[x] = value;
                    inputs.means[std::size_t(frame::Channel::HighVariance)].row(c, y)[x] =
                        value * hit->albedo;
                }
            }
        }
        return inputs;
    };
    session.restart(picture_of(from, 1000));
    session.restart(picture_of(to, 1));
    // Pixels whose point was not visible before, computed from the geometry.
    std::vector<bool> hidden, dropped;
    double error = 0.0, kept = 0.0;
    const auto sharp = picture_of(to, 1);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const auto hit = scene.trace(to, width, height, x + 0.5, y + 0.5);
            const glm::dvec4 before =
                glm::inverse(from.world_from_camera) * glm::dvec4(hit->point + scene.origin, 1.0);
            const double px = (before.x / -before.z - from.left) / (from.right - from.left) * width;
            const double py = (before.y / -before.z - from.top) / (from.bottom - from.top) * height;
            const bool outside = px < 0.0 || py < 0.0 || px > width || py > height;
            const auto seen = outside ? std::nullopt : scene.trace(from, width, height, px, py);
            hidden.push_back(!seen || glm::distance(seen->point, hit->point) > 1e-6);
            dropped.push_back(session.age(x, y) < 1.5f);
            if (dropped.back() || hidden.back()) continue;
            const double d =
                session.map("irradiance").row(0, y)[x] - sharp.mean(frame::Channel::Irradiance).row(0, y)[x];
            error += d * d;
            kept += 1.0;
        }
    }
    const bool whole = std::ranges::count(hidden, true) == 0;
    if (whole) {
        EXPECT_EQ(std::ranges::count(dropped, true), 0);
    } else {
        EXPECT_GT(overlap(hidden, dropped, width), 0.95);
    }
    // Bilinear interpolation of a sine of this frequency: a pixel of the wall is 0.06 wide.
    EXPECT_LT(std::sqrt(error / kept), 0.5 * 0.5 * std::pow(0.07 * 2.3, 2) / 2.0);
    EXPECT_NEAR(session.age(width / 2, height / 2), 1001.0f, 1.0f);
}

INSTANTIATE_TEST_SUITE_P(Cameras, PsvgfMove,
                         testing::Values(Move{{0.3, 0.0, 0.0}, 0.0}, Move{{0.02, -0.015, 0.0}, 0.0},
                                         Move{{0.0, 0.0, -0.8}, 0.0}, Move{{0.1, 0.05, 0.3}, 0.05},
                                         Move{{0.0, 0.0, 0.0}, -0.1}));

TEST(PsvgfHistory, IsExactForAStaticCamera) {  // DT22: no drift over 100 frames
    PlanesScene scene;
    scene.tilt = 0.3;
    const auto camera = looking_at(scene, {0.37, 0.11, 0.0}, Width, Height, 0.1);
    Session session(Raw + "r0=0");
    const Inputs first = photograph(scene, camera, {.n = 16, .seed = 1});
    session.restart(first);
    const Planes kept = session.map("irradiance");
    const Inputs still = [&] {
        Inputs inputs = first;
        std::ranges::fill(inputs.counts.values(), 1e-20f);  // surfaces, but practically no samples
        return inputs;
    }();
    for (int k = 0; k < 100; ++k) session.restart(still);
    EXPECT_LT(largest_difference(session.map("irradiance"), kept), 1e-6);
}

}  // namespace
}  // namespace tessera::filter
