// Pictures with alternating tiles of both back-ends have no visible seams.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "mediator/frame/resolve.h"
#include "tests/parity/both.h"

namespace tessera::test {
namespace {

constexpr std::int32_t SeamSize = 256, Edge = 16;

bool is_vulkans(std::int32_t x, std::int32_t y) {
    return (x / Edge + y / Edge) % 2 != 0;
}

enum class Source { Embree, Mixed };

// Mixed: a chessboard with fields of 16 x 16 pixels, alternately from either back-end.
frame::Image picture_of(const std::string& name, Source source, frame::SampleBlock block) {
    const tools::bench::BenchScene scene = bench_scene(name);
    view::View view = square_view(scene, SeamSize);
    view.channels = {frame::Channel::Radiance};
    const Renderer embree("embree", scene), vulkan("vulkan", scene);
    frame::FilmTile film(view.window, block, view.channels);
    for (std::int32_t y = 0; y < SeamSize; y += Edge) {
        for (std::int32_t x = 0; x < SeamSize; x += Edge) {
            const Renderer& renderer = source == Source::Mixed && is_vulkans(x, y) ? vulkan : embree;
            paste(film, renderer.film(view, {x, y, Edge, Edge}, block));
        }
    }
    return resolve(film, frame::Channel::Radiance);
}

float brightness(const frame::Image& picture, std::int32_t x, std::int32_t y) {
    const auto pixel = picture.pixel(static_cast<std::size_t>(y * SeamSize + x));
    return pixel[0] + pixel[1] + pixel[2];
}

// (a - b) / (a + b) of all neighbours a, b with the border of a chessboard between them, a on its white side;
// the board is moved by `shift`. Shifted by half a field, its borders are inside the fields of the picture.
std::vector<double> contrasts(const frame::Image& picture, std::int32_t shift) {
    std::vector<double> found;
    const auto add = [&](std::int32_t x0, std::int32_t y0, std::int32_t x1, std::int32_t y1) {
        const double sign = is_vulkans(x0 + shift, y0 + shift) ? 1.0 : -1.0;
        const double a = brightness(picture, x0, y0), b = brightness(picture, x1, y1);
        found.push_back(a + b > 0.0f ? sign * (a - b) / (a + b) : 0.0);
    };
    for (std::int32_t border = Edge - shift; border < SeamSize; border += Edge) {
        for (std::int32_t i = 0; i < SeamSize; ++i) {
            add(border - 1, i, border, i);
            add(i, border - 1, i, border);
        }
    }
    return found;
}

// Of the rank sum of `a` among both (Mann and Whitney 1947): normal with variance 1 where both are drawn from
// one distribution.
double rank_score(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<std::pair<double, int>> all;
    for (const double value : a) all.emplace_back(value, 1);
    for (const double value : b) all.emplace_back(value, 0);
    std::sort(all.begin(), all.end());
    double sum = 0.0;
    for (std::size_t from = 0; from < all.size();) {
        std::size_t to = from;
        double ours = 0.0;
        for (; to < all.size() && all[to].first == all[from].first; ++to) ours += all[to].second;
        sum += ours * 0.5 * static_cast<double>(from + to + 1);  // ties share their mean rank
        from = to;
    }
    const double n = double(a.size()), m = double(b.size());
    return (sum - 0.5 * n * (n + m + 1.0)) / std::sqrt(n * m * (n + m + 1.0) / 12.0);
}

// Signed contrasts of the borders against those of the interior: a step from field to field.
double step_score(const frame::Image& picture) {
    return rank_score(contrasts(picture, 0), contrasts(picture, Edge / 2));
}

// Absolute contrasts of the borders against those at the same positions of a picture without borders: a
// difference in noise.
double noise_score(const frame::Image& picture, const frame::Image& control) {
    std::vector<double> ours = contrasts(picture, 0), theirs = contrasts(control, 0);
    for (double& value : ours) value = std::fabs(value);
    for (double& value : theirs) value = std::fabs(value);
    return rank_score(ours, theirs);
}

// The picture with its Vulkan fields changed: c becomes factor (c (1 - fraction) + fraction other).
frame::Image with_seams(frame::Image picture, float factor, float fraction, const frame::Image& other) {
    for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
        const auto at = static_cast<std::int32_t>(i);
        if (!is_vulkans(at % SeamSize, at / SeamSize)) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            float& value = picture.pixel(i)[c];
            value = factor * ((1.0f - fraction) * value + fraction * other.pixel(i)[c]);
        }
    }
    return picture;
}

// Two-sided: 6 in 100,000 pictures without seams go beyond it.
constexpr double Most = 4.0;

class Seams : public testing::TestWithParam<const char*> {};

TEST_P(Seams, BordersOfTilesAreLikeTheirInterior) {
    const frame::Image picture = picture_of(GetParam(), Source::Mixed, {0, 4});
    const frame::Image control = picture_of(GetParam(), Source::Embree, {16, 4});
    EXPECT_LE(std::fabs(step_score(picture)), Most);
    EXPECT_LE(std::fabs(noise_score(picture, control)), Most);

    // The test detects seams: 3 % more light in one back-end's tiles, or the noise of a fifth of the samples.
    const frame::Image brighter = with_seams(picture, 1.03f, 0.0f, control);
    const frame::Image noisier = with_seams(picture, 1.0f, -1.0f, control);
    EXPECT_GT(std::fabs(step_score(brighter)), Most);
    EXPECT_GT(std::fabs(noise_score(noisier, control)), Most);
    std::printf("%s: step %.2f (3 %% more light: %.2f), noise %.2f (a fifth of the samples: %.2f)\n",
                GetParam(), step_score(picture), step_score(brighter), noise_score(picture, control),
                noise_score(noisier, control));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Seams, testing::Values("cornell", "room-1"), [](const auto& scene) {
    std::string name = scene.param;
    std::erase(name, '-');
    return name;
});

}  // namespace
}  // namespace tessera::test
