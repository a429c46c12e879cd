// Every filter on hard films: single bright pixels, black tiles, few and unequal samples, counts near 2^32.
#include <algorithm>
#include <cmath>
#include <limits>

#include "mediator/base/random.h"
#include "mediator/frame/channels.h"
#include "tests/contract/filter_cases.h"

namespace tessera::filter::test {
namespace {

using frame::Channel;

constexpr std::uint32_t LimitWidth = 72, LimitHeight = 56;

class FilterLimits : public FilterContract {
  protected:
    // Finite, without holes, and not negative, as the inputs are.
    const Planes& checked(Subject& subject, const Inputs& inputs, const std::string& what) const {
        const Planes& picture = subject.picture(inputs);
        EXPECT_EQ(first_not_finite(picture), "") << name() << ": " << what;
        const float least = std::ranges::min(picture.values());
        EXPECT_GE(least, 0.0f) << name() << ": " << what;
        return picture;
    }
};

double energy(const Planes& picture) {
    double sum = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (const float value : picture.plane(c)) sum += value;
    }
    return sum;
}

Planes colors(const Inputs& inputs) {
    Planes planes(inputs.width, inputs.height, inputs.color_components());
    for (std::uint32_t c = 0; c < planes.components(); ++c) {
        std::ranges::copy(inputs.color(c), planes.plane(c).begin());
    }
    return planes;
}

// A surface of albedo 0.5 that receives this light.
SyntheticSample surface(float light) {
    SyntheticSample s;
    s.albedo.fill(0.5f);
    s.irradiance.fill(2.0f * light);
    s.high.fill(light);
    s.shading = 2.0f * light;
    return s;
}

// Exponentially distributed, with this mean.
float noisy(float mean, std::uint32_t x, std::uint32_t y, std::uint64_t sample) {
    CounterRandom random(41, mix((std::uint64_t{y} << 32 | x) ^ mix(sample)));
    return -mean * static_cast<float>(std::log(1.0 - random.uniform()));
}

enum class Bright { EverySample, OneSample };

Inputs one_bright_pixel(std::uint64_t n, Bright which) {
    return synthetic_inputs(LimitWidth, LimitHeight, n, [=](auto x, auto y, auto i) {
        const bool bright =
            x == LimitWidth / 2 && y == LimitHeight / 2 && (which == Bright::EverySample || i == 0);
        return surface(bright ? 1e6f : noisy(1e-3f, x, y, i));
    });
}

// Far from it nothing changes, and no light is added. That of an outlier may be lost: filters that take it for noise
// replace it, and with one sample a lamp looks like noise.
TEST_P(FilterLimits, OneBrightPixelAmongDarkOnes) {
    for (const std::uint64_t n : {1, 2, 3, 4, 16}) {
        for (const Bright which : {Bright::EverySample, Bright::OneSample}) {
            const Inputs inputs = one_bright_pixel(n, which);
            Subject subject(entry(), inputs);
            const std::string what =
                std::to_string(n) + (which == Bright::OneSample ? ", one of them bright" : ", bright");
            const Planes& picture = checked(subject, inputs, what);
            const double kept = energy(picture) / energy(colors(inputs));
            EXPECT_LE(kept, 1.001) << name() << ": " << what;
            EXPECT_GE(kept, n == 1 ? 0.1 : 0.7) << name() << ": " << what;
            if (n == 1 || !entry().description.consistent) continue;
            double corner = 0.0;
            for (std::uint32_t y = 0; y < 4; ++y) {
                for (std::uint32_t x = 0; x < 4; ++x) corner += picture.row(0, y)[x] / 16.0;
            }
            EXPECT_NEAR(corner, 1e-3, 0.3e-3) << name() << ": " << what;
        }
    }
}

TEST_P(FilterLimits, BlackTiles) {
    for (const std::uint64_t n : {1, 2, 3, 4, 16}) {
        const Inputs inputs = synthetic_inputs(LimitWidth, LimitHeight, n, [](auto x, auto y, auto i) {
            const bool black = (x / 16 + y / 16) % 2 == 0;
            SyntheticSample s = surface(black ? 0.0f : noisy(1.0f, x, y, i));
            if (black && x < 32) s.albedo = s.headlight = {};  // black of its own; without light otherwise
            return s;
        });
        Subject subject(entry(), inputs);
        const Planes& picture = checked(subject, inputs, std::to_string(n));
        EXPECT_NEAR(energy(picture) / energy(colors(inputs)), 1.0, 0.15) << name() << ": " << n;
    }
}

// Tiles of none to 64 samples, a tenth of which were rejected.
TEST_P(FilterLimits, UnequalCountsAndRejectedSamples) {
    constexpr std::array<std::uint64_t, 8> Counts{0, 1, 2, 3, 5, 7, 33, 64};
    const Inputs inputs = synthetic_inputs(LimitWidth, LimitHeight, 64, [&](auto x, auto y, auto i) {
        const std::uint64_t count = Counts[mix(x / 8 + 100 * (y / 8)) % Counts.size()];
        const bool lost = mix(i + 1000 * (x + 100 * y)) % 10 == 0;
        return i < count && !lost ? surface(noisy(1.0f, x, y, i)) : rejected();
    });
    Subject subject(entry(), inputs);
    const Planes& picture = checked(subject, inputs, "");
    if (is_one_of({"none"})) return;  // leaves holes as they are
    double sum = 0.0, sum_of_holes = 0.0, holes = 0.0;
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        sum += picture.plane(0)[i];
        if (inputs.counts.plane(0)[i] > 0.0f) continue;
        ASSERT_GT(picture.plane(0)[i], 0.0f) << name() << ": a hole at " << i;
        sum_of_holes += picture.plane(0)[i];
        holes += 1.0;
    }
    ASSERT_GT(holes, 300.0);
    EXPECT_NEAR(sum / double(inputs.pixel_count()), 1.0, 0.05) << name();
    EXPECT_NEAR(sum_of_holes / holes, 1.0, 0.1) << name();
}

// A picture whose first tiles have arrived: the rest shows something rather than black.
TEST_P(FilterLimits, LargeHoles) {
    if (is_one_of({"none"})) GTEST_SKIP() << "leaves holes as they are, by its definition";
    const Inputs inputs = synthetic_inputs(200, 40, 4, [](auto x, auto y, auto i) {
        return x < 16 && y < 16 ? surface(noisy(1.0f, x, y, i)) : rejected();
    });
    Subject subject(entry(), inputs);
    const Planes& picture = checked(subject, inputs, "");
    const auto [least, most] = std::ranges::minmax(picture.plane(0).last(200 * 20));
    EXPECT_GT(least, is_one_of({"nfor"}) ? 0.05f : 0.4f) << name();  // its planes are tilted by the noise
    EXPECT_LT(most, 2.0f) << name();
}

// As if every sample had been drawn this many times.
frame::FilmTile repeated(frame::FilmTile film, std::uint32_t times) {
    const auto k = static_cast<float>(times);
    for (std::uint32_t& count : film.counts) count *= times;
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (!film.channels.contains(entry.channel)) continue;
        const std::uint32_t first = film.channels.first_plane(entry.channel);
        const auto scale = [&](std::uint32_t plane, float factor) {
            for (float& value : film.plane(first + plane)) value *= factor;
        };
        switch (entry.rule) {
            case frame::MergeRule::Moments:
                for (std::uint32_t c = 0; c < entry.components; ++c) scale(entry.components + c, k);
                break;
            case frame::MergeRule::Sum:
                for (std::uint32_t c = 0; c < entry.components; ++c) scale(c, k);
                break;
            case frame::MergeRule::BlockVariance:
                for (std::uint32_t c = 0; c < entry.components; ++c) scale(c, 1.0f / k);
                break;
            case frame::MergeRule::FirstHalf:
                scale(entry.components - 1, k);
                break;
            default:
                break;
        }
    }
    return film;
}

// 2^32 - 1 samples say that the picture is right: a filter whose error vanishes leaves it as it is.
TEST_P(FilterLimits, CountsNearTheLargest) {
    for (const std::uint32_t n : {1u, 2u, 3u, 4u}) {
        const frame::FilmTile few =
            synthetic_film(LimitWidth, LimitHeight, n, EveryChannel,
                           [](auto x, auto y, auto i) { return room(LimitWidth, LimitHeight, x, y, i); });
        const view::View view = synthetic_view(LimitWidth, LimitHeight);
        Inputs inputs = make_inputs(repeated(few, std::numeric_limits<std::uint32_t>::max() / n), view);
        ASSERT_GE(inputs.counts.plane(0)[0], 4.29e9f);
        Subject subject(entry(), inputs);
        for (const bool restarted : {false, true}) {
            inputs.changes.film_restarted = restarted;
            const Planes& picture = checked(subject, inputs, std::to_string(n));
            EXPECT_NEAR(energy(picture) / energy(colors(inputs)), 1.0, 0.15) << name() << ": " << n;
            if (!entry().description.consistent || restarted) continue;
            double worst = 0.0;
            for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
                worst = std::max(worst, std::abs(double(picture.plane(1)[i]) - inputs.color(1)[i]));
            }
            EXPECT_LT(worst, 1e-3) << name() << ": " << n;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Catalog, FilterLimits, testing::Range<std::size_t>(0, catalog().size()),
                         filter_name);

}  // namespace
}  // namespace tessera::filter::test
