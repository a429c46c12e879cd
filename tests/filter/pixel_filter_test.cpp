// The pixel filter as a whole: convergence, threshold, spikes, schedule, holes (Schwenk 3.3 to 3.6).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "master/filter/catalog.h"
#include "mediator/base/random.h"
#include "mediator/filter/choice.h"
#include "tests/filter/pixel_pictures.h"

namespace tessera::filter {
namespace {

using frame::Channel;

constexpr std::uint32_t PictureSize = 96;

Inputs shadows(std::uint64_t n, std::uint64_t seed = 1) {
    return synthetic_inputs(PictureSize, PictureSize, n,
                            [seed](std::uint32_t x, std::uint32_t y, std::uint64_t i) {
                                return shadowed_texture(PictureSize, PictureSize, x, y, i, seed);
                            });
}

// A wave of light that the guide does not show, on a plain wall; samples are exponentially distributed.
float caustic_at(std::uint32_t x, std::uint32_t y) {
    const double wave = std::sin(0.11 * x + 0.05 * y) + std::sin(0.07 * y - 0.02 * x);
    return static_cast<float>(0.2 + 3.0 * std::exp(-30.0 * wave * wave));
}

Inputs caustics(std::uint64_t n, std::uint64_t seed) {
    return synthetic_inputs(
        PictureSize, PictureSize, n, [seed](std::uint32_t x, std::uint32_t y, std::uint64_t i) {
            SyntheticSample sample;
            CounterRandom random(mix(seed + 77 * i), std::uint64_t{y} << 32 | x);
            const auto light =
                static_cast<float>(-std::log(1.0 - random.uniform()) * double(caustic_at(x, y)));
            sample.high = {light, 0.7f * light, 0.4f * light};
            return sample;
        });
}

bool same_bits(float a, float b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(PixelFilter, IsTheUnfilteredPictureWhereItHasConverged) {
    const Inputs inputs = shadows(2048);
    const Output out = run_filter("pixel", inputs, true);
    const Planes& blend = map_of(out, "blend");
    std::size_t converged = 0;
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        if (blend.plane(0)[i] < 1.0f) continue;
        ++converged;
        for (std::uint32_t c = 0; c < 4; ++c) {
            EXPECT_TRUE(same_bits(out.picture.plane(c)[i], inputs.color(c)[i]));
        }
    }
    EXPECT_GE(static_cast<double>(converged), 0.99 * static_cast<double>(inputs.pixel_count()));
}

// relMSE 0.25 is a root of 0.5.
TEST(PixelFilter, HalvesTheErrorAtFourSamplesAndLowersItLater) {
    const Planes truth = shadowed_texture_truth(PictureSize, PictureSize);
    for (const std::uint64_t n : {4, 8, 16, 32}) {
        const Inputs inputs = shadows(n);
        for (const char* choice : {"pixel", "pixel:root=simple", "pixel:adaptive=off", "pixel:method=brute",
                                   "pixel:method=atrous"}) {
            const double ratio = relative_error(run_filter(choice, inputs).picture, truth) /
                                 relative_error(inputs.mean(Channel::Radiance), truth);
            EXPECT_LT(ratio, n == 4 ? 0.25 : 1.0) << choice << " " << n;
        }
    }
}

// Without the convergence blend, which may exceed the threshold. The simple root ignores the covariance,
// which grows as the adaptive kernels shrink.
TEST(PixelFilter, MeetsTheThresholdInTheMedian) {
    constexpr int Seeds = 64;
    for (const char* choice : {"pixel:blend=off,root=simple", "pixel:blend=off"}) {
        // The design effect of independent samples is a little below 1 (frame/design_effect.h).
        const double slack = std::string(choice) == "pixel:blend=off" ? 1.05 : 1.5;
        for (const std::uint64_t n : {4, 16}) {
            std::vector<double> sum(PictureSize * PictureSize, 0.0), squares(PictureSize * PictureSize, 0.0);
            for (int seed = 0; seed < Seeds; ++seed) {
                const Output out = run_filter(choice, shadows(n, static_cast<std::uint64_t>(seed) + 1));
                for (std::size_t i = 0; i < sum.size(); ++i) {
                    const double value = 0.2126 * out.picture.plane(0)[i] + 0.7152 * out.picture.plane(1)[i] +
                                         0.0722 * out.picture.plane(2)[i];
                    sum[i] += value;
                    squares[i] += value * value;
                }
            }
            std::vector<double> perceived;
            for (std::size_t i = 0; i < sum.size(); ++i) {
                const double mean = sum[i] / Seeds;
                perceived.push_back((squares[i] / Seeds - mean * mean) / (mean * mean));
            }
            std::ranges::sort(perceived);
            EXPECT_LE(perceived[perceived.size() / 2], 0.01 * slack) << choice << " " << n;
            // Early misses are expected: the widths and s follow estimated variances.
            EXPECT_LE(perceived[perceived.size() * 95 / 100], 0.03) << choice << " " << n;
        }
    }
}

TEST(AdaptiveWidths, StayNearTheGuideLineAndHelpCaustics) {
    Planes truth(PictureSize, PictureSize, 3);
    for (std::uint32_t y = 0; y < PictureSize; ++y) {
        for (std::uint32_t x = 0; x < PictureSize; ++x) {
            const float light = caustic_at(x, y);
            truth.row(0, y)[x] = light;
            truth.row(1, y)[x] = 0.7f * light;
            truth.row(2, y)[x] = 0.4f * light;
        }
    }
    for (const std::uint64_t n : {16, 64, 256}) {
        const Inputs inputs = caustics(n, 3);
        const Output out = run_filter("pixel:blend=off", inputs, true);
        const float guide = 8.0f / std::sqrt(static_cast<float>(n));
        for (const float sigma : map_of(out, "width").values()) {
            EXPECT_GE(sigma, guide / 4.0f * 0.9999f);
            EXPECT_LE(sigma, guide * 4.0f * 1.0001f);
        }
        const Output fixed = run_filter("pixel:blend=off,adaptive=off", inputs);
        EXPECT_LT(mean_squared_error(out.picture, truth), mean_squared_error(fixed.picture, truth)) << n;
    }
}

TEST(SpikeClamp, BoundsASpikeAndKeepsAConvergedPixel) {
    for (const float variance : {0.05f, 1e-6f}) {
        const Inputs inputs = pixel_inputs(48, 48, [&](std::uint32_t x, std::uint32_t y) {
            const bool spike = x == 24 && y == 24;
            return PixelLight{.high = spike ? 100.0f : 1.0f, .variance = variance};
        });
        const Output filtered = run_filter(FilteredLight, inputs);
        const Output out = run_filter("pixel:blend=off,adaptive=off", inputs, true);
        const float s = map_of(out, "blend").row(0, 24)[24];
        const float value = out.picture.row(0, 24)[24];
        if (variance > 1e-3f) {
            EXPECT_LT(s, 1.0f);
            EXPECT_LE(value, (1.0f + s) * filtered.picture.row(0, 24)[24] * 1.0001f);
            const Output loose = run_filter("pixel:blend=off,adaptive=off,spike_clamp=0", inputs);
            EXPECT_GT(loose.picture.row(0, 24)[24], 10.0f * value);
        } else {
            EXPECT_EQ(s, 1.0f);
            EXPECT_EQ(value, 100.0f);
        }
    }
}

// A step in the light that the guide does not show. A narrow kernel blurs it, and gives the pixel itself much
// weight: what is left of its noise is correlated with its samples. Without that knowledge the convergence
// blend takes bias for noise: the error is 0.515 of the unfiltered instead of 0.486.
TEST(PixelFilter, ItsConvergenceBlendKnowsTheWeightOfThePixelItself) {
    double error = 0.0, unfiltered = 0.0;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
        Planes truth(48, 48, 3);
        const Inputs inputs = pixel_inputs(48, 48, [&](std::uint32_t x, std::uint32_t y) {
            const float light = x % 4 < 2 ? 0.5f : 1.5f;
            for (std::uint32_t c = 0; c < 3; ++c) truth.row(c, y)[x] = light;
            const float deviation = std::sqrt(12.0f) * 0.3f * (noise(seed, x, y) - 0.5f);
            return PixelLight{.high = light + deviation, .variance = 0.09f};
        });
        const std::string choice = "pixel:t=0.000001,adaptive=off,spike_clamp=0,sigma_s=0.6";
        error += relative_error(run_filter(choice, inputs).picture, truth);
        unfiltered += relative_error(inputs.mean(Channel::Radiance), truth);
    }
    EXPECT_LT(error / unfiltered, 0.49);
}

// One film that grows, and the instance that shows it.
class Growing {
  public:
    explicit Growing(const std::string& text)
        : choice_(parse_choice(text, catalog()).value()), filter_(choice_.entry->make(32, 32)) {}

    Report show(std::uint64_t n, Changes changes = {}) {
        inputs_ = synthetic_inputs(32, 32, n, [](std::uint32_t x, std::uint32_t y, std::uint64_t i) {
            return shadowed_texture(32, 32, x, y, i);
        });
        inputs_.changes = changes;
        return filter_->run(inputs_, choice_.values, out_, {arena_, {}});
    }
    bool filters(std::uint64_t n, Changes changes = {}) {
        const Report report = show(n, changes);
        return std::ranges::any_of(report.passes, [](const Pass& pass) { return pass.name == "filter"; });
    }
    void choose(const std::string& text) { choice_ = parse_choice(text, catalog()).value(); }
    void reset() { filter_->reset(); }
    const Inputs& inputs() const { return inputs_; }
    const Planes& picture() const { return out_.picture; }

  private:
    Choice choice_;
    std::unique_ptr<Filter> filter_;
    tbb::task_arena arena_{2};
    Inputs inputs_;
    Output out_;
};

TEST(Schedule, FiltersAtFourEightSixteen) {
    Growing film("pixel:schedule=on");
    std::vector<std::uint64_t> passes;
    for (std::uint64_t n = 1; n <= 40; ++n) {
        if (film.filters(n)) passes.push_back(n);
        if (n >= 4) continue;
        for (std::uint32_t c = 0; c < 3; ++c) {
            EXPECT_TRUE(std::ranges::equal(film.picture().plane(c), film.inputs().color(c)));
        }
    }
    EXPECT_EQ(passes, (std::vector<std::uint64_t>{4, 8, 16, 32}));
}

TEST(Schedule, IsOffForSinglePictures) {
    Growing film("pixel");
    for (const std::uint64_t n : {1, 2, 5, 6}) EXPECT_TRUE(film.filters(n)) << n;
}

TEST(Schedule, RestartsAfterAChange) {
    Growing film("pixel:schedule=on");
    EXPECT_TRUE(film.filters(5));
    EXPECT_FALSE(film.filters(6));
    film.choose("pixel:schedule=on,t=0.02");
    EXPECT_TRUE(film.filters(7));
    EXPECT_FALSE(film.filters(7));
    EXPECT_TRUE(film.filters(7, {.film_restarted = true}));
    EXPECT_TRUE(film.filters(7, {.lights_or_materials = true}));
    EXPECT_TRUE(film.filters(7, {.geometry = true}));
    EXPECT_TRUE(film.filters(6));  // fewer samples than at the last pass: a new film
    EXPECT_FALSE(film.filters(3, {.film_restarted = true}));
    EXPECT_TRUE(film.filters(4));
    EXPECT_FALSE(film.filters(5));
    film.reset();
    EXPECT_TRUE(film.filters(5));
}

// Between passes new samples contribute through the unfiltered light, whose variance decreases.
TEST(Schedule, TakesNewSamplesBetweenPasses) {
    const Planes truth = shadowed_texture_truth(32, 32);
    Growing scheduled("pixel:schedule=on"), always("pixel");
    scheduled.show(16);
    const double at_pass = relative_error(scheduled.picture(), truth);
    scheduled.show(31);
    always.show(31);
    const double between = relative_error(scheduled.picture(), truth);
    EXPECT_LT(between, at_pass);
    // The last pass used half of the samples.
    EXPECT_LT(between, 2.0 * relative_error(always.picture(), truth));
}

TEST(PixelFilter, FillsHolesFromPixelsThatLookLikeTheirNeighbours) {
    for (const char* method : {"separable", "brute", "atrous"}) {
        for (const double missing : {0.1, 0.7}) {
            const Inputs inputs = pixel_inputs(64, 64, [&](std::uint32_t x, std::uint32_t y) {
                if (noise(9, x, y) < missing) {
                    return PixelLight{
                        .headlight = 0.0f, .depth = std::numeric_limits<float>::infinity(), .n = 0};
                }
                const float light = x < 32 ? 1.0f : 0.25f;
                return PixelLight{
                    .high = light, .variance = light * light, .headlight = x < 32 ? 0.9f : 0.1f, .low = 2.0f};
            });
            const Output out = run_filter(std::string("pixel:method=") + method, inputs);
            for (std::uint32_t y = 0; y < 64; ++y) {
                for (std::uint32_t x = 0; x < 64; ++x) {
                    if (x > 24 && x < 40) continue;  // the nearest sample may be across the edge
                    EXPECT_NEAR(out.picture.row(1, y)[x], 2.0f + (x < 32 ? 1.0f : 0.25f), 1e-5f)
                        << x << " " << y;
                }
            }
        }
    }
}

TEST(PixelFilter, FiltersAlphaWithTheSameWeights) {
    const Inputs inputs = pixel_inputs(48, 48, [](std::uint32_t x, std::uint32_t y) {
        const float part = noise(3, x, y);
        return PixelLight{.high = part, .variance = 0.1f, .alpha = part};
    });
    const Output out = run_filter("pixel:spike_clamp=0", inputs);
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        EXPECT_NEAR(out.picture.plane(3)[i], out.picture.plane(0)[i], 1e-5f);
    }
    const Output filtered = run_filter(FilteredLight, inputs);
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        EXPECT_NEAR(filtered.picture.plane(3)[i], filtered.picture.plane(0)[i], 1e-5f);
    }
}

TEST(PixelFilter, HasTheSameBitsOnAnyNumberOfThreads) {
    const Inputs inputs = shadows(4);
    for (const char* text : {"pixel", "pixel:method=brute", "pixel:method=atrous,normals=on"}) {
        const Choice choice = parse_choice(text, catalog()).value();
        Planes first;
        for (const int threads : {1, 2, 5}) {
            tbb::task_arena arena(threads);
            Output out;
            choice.entry->make(PictureSize, PictureSize)->run(inputs, choice.values, out, {arena, {}});
            if (first.empty()) first = out.picture;
            EXPECT_TRUE(std::ranges::equal(first.values(), out.picture.values())) << text << " " << threads;
        }
    }
}

TEST(PixelFilter, RequestsNormalsOnlyWhenUsed) {
    const Choice plain = parse_choice("pixel", catalog()).value();
    EXPECT_EQ(plain.channels(),
              (frame::ChannelSet{Channel::Radiance, Channel::LowVariance, Channel::HighVariance,
                                 Channel::Depth, Channel::Headlight}));
    EXPECT_TRUE(parse_choice("pixel:normals=on", catalog()).value().channels().contains(Channel::Normal));
}

TEST(PixelFilter, FiltersWithoutOptionalChannelsAndWarns) {
    Inputs inputs = shadows(4);
    inputs.means[static_cast<std::size_t>(Channel::HighVariance)] = {};
    inputs.means[static_cast<std::size_t>(Channel::Headlight)] = {};
    const Choice choice = parse_choice("pixel", catalog()).value();
    tbb::task_arena arena(2);
    Output out;
    const Report report =
        choice.entry->make(PictureSize, PictureSize)->run(inputs, choice.values, out, {arena, {}});
    EXPECT_EQ(report.notes.size(), 2u);
    for (const float value : out.picture.values()) EXPECT_TRUE(std::isfinite(value));
}

TEST(PixelFilter, StopsWhenAsked) {
    std::stop_source stop;
    stop.request_stop();
    const Choice choice = parse_choice("pixel", catalog()).value();
    tbb::task_arena arena(2);
    Output out;
    const Inputs inputs = shadows(4);
    EXPECT_TRUE(choice.entry->make(PictureSize, PictureSize)
                    ->run(inputs, choice.values, out, {arena, stop.get_token()})
                    .stopped);
}

}  // namespace
}  // namespace tessera::filter
