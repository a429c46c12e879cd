#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "master/filter/nfor/regression.h"
#include "master/filter/nfor/selection.h"
#include "master/filter/self_weight.h"
#include "mediator/base/random.h"
#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

// A window of 7 x 7 pixels around eight centres, with planes that a fit reads.
struct Fitting {
    static constexpr std::size_t Columns = 16, Rows = 7, Plane = Columns * Rows;
    static constexpr std::ptrdiff_t Centre = 3 * Columns + 3;

    Fitting() : values(Plane * (nfor::FeatureCount + nfor::Colors + 1)) {
        for (int dy = -3; dy <= 3; ++dy) {
            for (int dx = -3; dx <= 3; ++dx) {
                taps.push_back({static_cast<float>(dx), static_cast<float>(dy), dy * 16 + dx});
            }
        }
        CounterRandom random(1);
        weights.resize(taps.size() * PackSize);
        for (float& weight : weights) weight = static_cast<float>(0.1 + random.uniform());
        for (float& value : values) value = static_cast<float>(random.uniform());
        for (float* v = noise(); v != noise() + Plane; ++v) *v = 0.0f;
    }
    float* feature(std::size_t i) { return values.data() + i * Plane; }
    float* color(std::size_t c) { return feature(nfor::FeatureCount + c); }
    float* noise() { return color(nfor::Colors); }
    nfor::Window window() { return {taps, feature(0) + Centre, color(0) + Centre, noise() + Centre, Plane}; }
    nfor::Fit fit() {
        nfor::Fit result;
        result.solve(window(), weights.data());
        return result;
    }
    // The largest difference between model and data, over centres, pixels and colours.
    float worst() {
        const nfor::Fit model = fit();
        float most = 0.0f;
        for (const nfor::Tap& tap : taps) {
            const auto predicted = model.at(window(), tap);
            for (std::size_t c = 0; c < nfor::Colors; ++c) {
                for (std::size_t lane = 0; lane < PackSize; ++lane) {
                    const float* at = color(c) + Centre + lane;
                    most = std::max(most, std::abs(predicted[c][lane] + at[0] - at[tap.offset]));
                }
            }
        }
        return most;
    }

    std::vector<nfor::Tap> taps;
    std::vector<float> weights, values;
};

TEST(NforFit, ReproducesLinearFunctionsOfTheVariables) {
    Fitting f;
    for (std::size_t i = 0; i < Fitting::Plane; ++i) {
        for (std::size_t c = 0; c < nfor::Colors; ++c) {
            f.color(c)[i] = 0.3f + 0.02f * static_cast<float>(i % Fitting::Columns) + 0.2f * f.feature(0)[i] -
                            0.1f * static_cast<float>(c) * f.feature(4)[i] + 0.05f * f.feature(6)[i];
        }
    }
    EXPECT_LT(f.worst(), 1e-4f);
}

TEST(NforFit, PredictsNothingThatFeaturesDoNotExplain) {
    Fitting f;
    EXPECT_GT(f.worst(), 0.2f);  // colours are random
}

TEST(NforFit, AcceptsDuplicateFeatures) {
    Fitting f;
    for (std::size_t i = 0; i < Fitting::Plane; ++i) {
        for (std::size_t feature = 1; feature < nfor::FeatureCount; ++feature) {
            f.feature(feature)[i] = 2.0f * f.feature(0)[i];
        }
        for (std::size_t c = 0; c < nfor::Colors; ++c) f.color(c)[i] = 0.5f + f.feature(0)[i];
    }
    EXPECT_LT(f.worst(), 1e-4f);
}

// The mean over the window of the squared difference between the model and the weighted mean of the colours.
double explained(Fitting& f, std::size_t lane) {
    const nfor::Fit model = f.fit();
    double sum = 0.0, weight = 0.0, squares = 0.0;
    for (const nfor::Tap& tap : f.taps) {
        const double w = f.weights[static_cast<std::size_t>(&tap - f.taps.data()) * PackSize + lane];
        const auto at = Fitting::Centre + static_cast<std::ptrdiff_t>(lane);
        weight += w;
        sum += w * (f.color(0)[at + tap.offset] - f.color(0)[at]);
    }
    for (const nfor::Tap& tap : f.taps) {
        const double d = model.at(f.window(), tap)[0][lane] - sum / weight;
        squares += d * d;
    }
    return squares / static_cast<double>(f.taps.size());
}

// Colours of noise alone: the fit follows it less when it knows of the noise.
TEST(NforFit, ShrinksToTheMeanWhereNoiseExplainsAll) {
    Fitting exact, noisy;
    for (std::size_t i = 0; i < Fitting::Plane; ++i) noisy.noise()[i] = 0.3f;  // of uniform numbers: 3 / 12
    for (std::size_t lane = 0; lane < PackSize; ++lane)
        EXPECT_LT(explained(noisy, lane), 0.8 * explained(exact, lane));
}

// Noise that is overestimated by far must not hide what a feature explains.
TEST(NforFit, KeepsTextureWhereTheNoiseIsOverestimated) {
    Fitting exact, noisy;
    for (Fitting* f : {&exact, &noisy}) {
        for (std::size_t i = 0; i < Fitting::Plane; ++i) {
            for (std::size_t c = 0; c < nfor::Colors; ++c) f->color(c)[i] = 2.0f * f->feature(0)[i];
            f->noise()[i] = f == &noisy ? 2.0f : 0.0f;  // twice the variance of the colours, 3 x 4 / 12
        }
    }
    for (std::size_t lane = 0; lane < PackSize; ++lane)
        EXPECT_GT(explained(noisy, lane), 0.4 * explained(exact, lane));
}

TEST(NforFit, EqualFeaturesChangeNothing) {
    // Features of one value each, against none: the fit sees the position alone in both.
    Fitting with, without;
    for (std::size_t i = 0; i < Fitting::Plane * nfor::FeatureCount; ++i) {
        with.values[i] = 0.7f;
        without.values[i] = 0.0f;
    }
    const nfor::Fit a = with.fit(), b = without.fit();
    for (const nfor::Tap& tap : with.taps) {
        for (std::size_t lane = 0; lane < PackSize; ++lane) {
            EXPECT_EQ(a.at(with.window(), tap)[0][lane], b.at(without.window(), tap)[0][lane]);
        }
    }
}

TEST(NforFit, WithoutWeightItIsFiniteAndUnknown) {
    Fitting f;
    std::ranges::fill(f.weights, 0.0f);
    const nfor::Fit model = f.fit();
    EXPECT_EQ(model.known()[0], 0.0f);
    for (const nfor::Tap& tap : f.taps) EXPECT_TRUE(std::isfinite(model.at(f.window(), tap)[0][0]));
}

// A curved surface: light linear in a normal that rotates across the picture and in a wavy albedo.
SyntheticSample curved_surface(std::uint32_t x, std::uint32_t y, std::uint64_t i, double noise) {
    const double angle = 2.0 * x / 64.0 + 0.5 * std::sin(0.2 * y);
    CounterRandom random(mix(3), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
    SyntheticSample s;
    s.normal = {static_cast<float>(std::sin(angle)), 0.0f, static_cast<float>(std::cos(angle))};
    s.albedo.fill(static_cast<float>(0.5 + 0.3 * std::sin(0.7 * x + 0.4 * y)));
    const double light = 1.0 + 0.5 * s.normal[0] + 0.3 * s.normal[2] + 0.4 * s.albedo[0];
    s.high.fill(static_cast<float>(light * (1.0 + noise * (2.0 * random.uniform() - 1.0))));
    return s;
}

TEST(Nfor, KeepsLightLinearInTheFeatures) {
    const Inputs exact =
        synthetic_inputs(64, 48, 1, [](auto x, auto y, auto) { return curved_surface(x, y, 0, 0.0); });
    const Inputs clean =
        synthetic_inputs(64, 48, 8, [](auto x, auto y, auto i) { return curved_surface(x, y, i, 0.0); });
    const Inputs noisy =
        synthetic_inputs(64, 48, 8, [](auto x, auto y, auto i) { return curved_surface(x, y, i, 1.0); });
    const Planes& truth = exact.mean(frame::Channel::Radiance);
    const Planes picture = run_filter("nfor", clean).picture;
    for (std::size_t i = 0; i < truth.values().size(); ++i) {
        EXPECT_NEAR(picture.values()[i], truth.values()[i], 1e-4f);
    }
    // A mean over similar pixels has more error, since it cannot follow changes of the light.
    const double unfiltered = mean_squared_error(noisy.mean(frame::Channel::Radiance), truth);
    const double first_order = mean_squared_error(run_filter("nfor:blend=off", noisy).picture, truth);
    EXPECT_LT(first_order, 0.05 * unfiltered);
    EXPECT_LT(first_order, 0.7 * mean_squared_error(run_filter("statmc:blend=off", noisy).picture, truth));
}

TEST(Nfor, FiltersWithoutHalfBuffersAndWarns) {
    const Inputs noisy =
        synthetic_inputs(64, 48, 8, [](auto x, auto y, auto i) { return curved_surface(x, y, i, 1.0); },
                         {frame::Channel::Radiance, frame::Channel::Normal});
    const Inputs exact =
        synthetic_inputs(64, 48, 1, [](auto x, auto y, auto) { return curved_surface(x, y, 0, 0.0); });
    const Planes& truth = exact.mean(frame::Channel::Radiance);
    EXPECT_LT(mean_squared_error(run_filter("nfor", noisy).picture, truth),
              0.2 * mean_squared_error(noisy.mean(frame::Channel::Radiance), truth));
}

TEST(Nfor, KeepsAnEdgeThatNoFeatureShows) {
    const Inputs inputs = synthetic_inputs(48, 32, 256, [](auto x, auto y, auto i) {
        CounterRandom random(mix(7), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
        SyntheticSample s;
        s.high.fill(static_cast<float>((x < 24 ? 1.0 : 2.0) * 2.0 * random.uniform()));
        return s;
    });
    const Output out = run_filter("nfor", inputs);
    for (std::uint32_t y = 0; y < 32; ++y) {
        EXPECT_NEAR(out.picture.row(0, y)[23], 1.0f, 0.1f);
        EXPECT_NEAR(out.picture.row(0, y)[24], 2.0f, 0.2f);
    }
}

TEST(Nfor, TheExposureDoesNotMatter) {
    const auto lit = [](float exposure) {
        return synthetic_inputs(48, 32, 8, [exposure](auto x, auto y, auto i) {
            SyntheticSample s = curved_surface(x, y, i, 1.0);
            for (float& light : s.high) light *= exposure;
            return s;
        });
    };
    const Planes once = run_filter("nfor", lit(1.0f)).picture;
    for (const float exposure : {1.0f / 1024.0f, 1024.0f}) {
        const Planes picture = run_filter("nfor", lit(exposure)).picture;
        for (std::size_t i = 0; i < 3 * once.pixel_count(); ++i)
            ASSERT_NEAR(picture.values()[i], exposure * once.values()[i], 1e-3f * exposure)
                << exposure << " " << i;
    }
}

// The result is the mean of two halves: noise of variance 1 in each is an error of 1/2, less than a bias of 0.8^2.
TEST(NforSelection, ComparesErrorsOfTheMeanOfBothHalves) {
    constexpr std::uint32_t Size = 32;
    Inputs inputs;
    inputs.width = inputs.height = Size;
    inputs.counts = Planes(Size, Size, 1);
    std::ranges::fill(inputs.counts.values(), 16.0f);
    std::mt19937 random(5);
    std::normal_distribution<float> noise;
    std::array<Planes, 2> colors;
    Planes variance(Size, Size, 3), counts(Size, Size, 1);
    std::ranges::fill(variance.values(), 4.0f);
    std::ranges::fill(counts.values(), 8.0f);
    std::array<std::array<Planes, 2>, 2> filtered;
    for (std::size_t h = 0; h < 2; ++h) {
        colors[h] = filtered[h][0] = filtered[h][1] = Planes(Size, Size, 4);
        for (std::size_t i = 0; i < 3 * std::size_t{Size} * Size; ++i) {
            colors[h].values()[i] = 10.0f + 2.0f * noise(random);
            filtered[h][0].values()[i] = 10.0f + noise(random);
            filtered[h][1].values()[i] = 10.8f;
        }
    }
    const auto half = [&](std::size_t h) {
        const Planes& c = colors[h];
        return nfor::Half{{c.plane(0), c.plane(1), c.plane(2), c.plane(3)}, c, variance, counts};
    };
    tbb::task_arena arena(2);
    RunContext context{arena, {}};
    nfor::Selection selection;
    ASSERT_TRUE(selection.run(inputs, {half(0), half(1)}, filtered, context));
    double narrow = 0.0;
    for (const float v : selection.first().values()) narrow += v / double(Size * Size);
    EXPECT_GT(narrow, 0.6);
}

// Noise of one normal number per column of 32, which neighbours share exactly, or one per pixel.
struct CorrelatedGuide {
    static constexpr std::uint32_t Width = 64, Height = 32;
    explicit CorrelatedGuide(bool shared) {
        std::mt19937 random(9);
        std::normal_distribution<float> noise;
        for (std::uint32_t y = 0; y < Height; ++y) {
            for (std::uint32_t x = 0; x < Width; ++x) {
                const bool first = shared && x % 32 != 0;
                values.row(0, y)[x] = first ? values.row(0, y)[x - 1] : 5.0f + noise(random);
                halves.row(0, y)[x] = first ? halves.row(0, y)[x - 1] : noise(random);
            }
        }
        std::ranges::fill(known.values(), 1.0f);
    }
    // Of the pixels of the first tile to those two columns to the right, the mean.
    double distance() {
        nfor::PatchDistance patches;
        patches.reserve({.radius = 2, .patch = 1}, 1);
        const Tile tile{0, 0, Tiles::Width, Tiles::Height};
        patches.load({values, halves, known, true}, tile);
        std::vector<float> to(std::size_t{Tiles::Width} * Tiles::Height);
        patches.compute(2, 0, 1, to.data());
        double sum = 0.0;
        for (std::size_t i = 0; i < to.size(); ++i) {
            if (i % Tiles::Width >= 4 && i % Tiles::Width < 26) sum += to[i] / (22.0 * Tiles::Height);
        }
        return sum;
    }
    Planes values{Width, Height, 1}, halves{Width, Height, 1}, known{Width, Height, 1};
};

TEST(NforPatchDistance, NoiseThatNeighboursShareHidesNoStep) {
    CorrelatedGuide equal(true), stepped(true), single(false);
    EXPECT_LT(equal.distance(), 1e-6);
    EXPECT_LT(single.distance(), 1.0);
    for (std::uint32_t y = 0; y < CorrelatedGuide::Height; ++y) {
        for (std::uint32_t x = 0; x < CorrelatedGuide::Width; ++x) {
            stepped.values.row(0, y)[x] += 0.1f * static_cast<float>(x);
            single.values.row(0, y)[x] += 0.1f * static_cast<float>(x);
        }
    }
    EXPECT_GT(stepped.distance(), 100.0);  // a fifth of the standard deviation, but none of it differs
    EXPECT_LT(single.distance(), 1.5);
}

// F = T + a (U - T), for halves of nA and nB samples of variance 1.
struct Halves {
    static constexpr std::uint32_t Size = 48;
    Halves(float a, float n_a, float n_b) {
        inputs.width = inputs.height = Size;
        std::mt19937 random(11);
        std::normal_distribution<float> noise;
        for (std::size_t i = 0; i < std::size_t{Size} * Size; ++i) {
            scale.values()[i] = std::sqrt(n_a * n_b) / (n_a + n_b);
            for (std::uint32_t c = 0; c < 3; ++c) {
                const float da = noise(random) / std::sqrt(n_a), db = noise(random) / std::sqrt(n_b);
                colors[0].plane(c)[i] = 10.0f + da;
                colors[1].plane(c)[i] = 10.0f + db;
                response[i] += scale.values()[i] * a * (da - db);
                filtered.plane(c)[i] = 10.0f + a * (n_a * da + n_b * db) / (n_a + n_b);
            }
        }
    }
    std::vector<float> weights() {
        tbb::task_arena arena(2);
        RunContext context{arena, {}};
        SelfWeight weight;
        std::vector<float> change(response.size(), 0.0f);
        for (std::uint32_t c = 0; c < 3; ++c) {
            for (std::size_t i = 0; i < change.size(); ++i)
                change[i] += colors[0].plane(c)[i] - colors[1].plane(c)[i];
        }
        EXPECT_TRUE(weight.run(inputs, change, scale.plane(0), response, filtered, context));
        return {weight.weights().begin(), weight.weights().end()};
    }
    Inputs inputs;
    std::array<Planes, 2> colors{Planes(Size, Size, 3), Planes(Size, Size, 3)};
    Planes scale{Size, Size, 1}, filtered{Size, Size, 3};
    std::vector<float> response = std::vector<float>(std::size_t{Size} * Size, 0.0f);
};

TEST(NforSelfWeight, IsTheWeightOfThePixelsOwnNoise) {
    for (const float a : {0.0f, 0.2f, 0.8f, 1.0f}) {
        for (const auto& [n_a, n_b] : {std::pair{8.0f, 8.0f}, {2.0f, 1.0f}, {1.0f, 64.0f}}) {
            for (const float w : Halves(a, n_a, n_b).weights()) ASSERT_NEAR(w, a, 1e-3f) << n_a << " " << n_b;
        }
    }
}

// Noise of F that has nothing to do with that of the pixel is no weight of its own.
TEST(NforSelfWeight, NoiseOfOthersDoesNotCount) {
    Halves halves(0.0f, 8.0f, 8.0f);
    std::mt19937 random(13);
    std::normal_distribution<float> noise;
    for (float& response : halves.response) response = noise(random);
    double mean = 0.0;
    for (const float w : halves.weights()) mean += w / (48.0 * 48.0);
    EXPECT_LT(mean, 0.1);
}

TEST(NforSelfWeight, EqualOrHugeHalvesGiveAFiniteWeight) {
    Halves black(0.0f, 1.0f, 1.0f), huge(0.5f, 8.0f, 8.0f);
    for (Planes& planes : black.colors) std::ranges::fill(planes.values(), 0.0f);
    std::ranges::fill(black.filtered.values(), 0.0f);
    for (const float w : black.weights()) EXPECT_EQ(w, 0.0f);
    huge.colors[0].values()[1000] = 1e30f;
    for (const float w : huge.weights()) EXPECT_TRUE(w >= 0.0f && w <= 1.0f);
}

// Of light and shade with uniform noise, `count(x, y)` samples a pixel.
Inputs shaded(std::uint64_t count, bool uneven) {
    const auto sample = [](auto x, auto y, auto i) { return curved_surface(x, y, i, 1.0); };
    Inputs inputs = synthetic_inputs(64, 48, count, sample);
    if (!uneven) return inputs;
    // Every other column has samples of a film with more of them.
    const Inputs more = synthetic_inputs(64, 48, 4 * count + 1, sample);
    const auto mix_in = [](Planes& to, const Planes& from) {
        for (std::size_t i = 0; i < to.values().size(); i += 2) to.values()[i] = from.values()[i];
    };
    mix_in(inputs.counts, more.counts);
    for (std::size_t i = 0; i < inputs.means.size(); ++i) mix_in(inputs.means[i], more.means[i]);
    for (std::size_t i = 0; i < inputs.variances.size(); ++i) mix_in(inputs.variances[i], more.variances[i]);
    for (std::size_t h = 0; h < 2; ++h) {
        mix_in(inputs.halves[h], more.halves[h]);
        mix_in(inputs.half_counts[h], more.half_counts[h]);
    }
    return inputs;
}

TEST(Nfor, LowersTheErrorOfFewAndOfUnevenSamples) {
    const Inputs exact =
        synthetic_inputs(64, 48, 1, [](auto x, auto y, auto) { return curved_surface(x, y, 0, 0.0); });
    const Planes& truth = exact.mean(frame::Channel::Radiance);
    for (const std::uint64_t n : {1, 2, 3, 5, 16}) {
        for (const bool uneven : {false, true}) {
            const Inputs inputs = shaded(n, uneven);
            const double unfiltered = mean_squared_error(inputs.mean(frame::Channel::Radiance), truth);
            EXPECT_LT(mean_squared_error(run_filter("nfor", inputs).picture, truth), 0.3 * unfiltered)
                << n << uneven;
        }
    }
}

// Patches that contain a bright edge are similar to few others, so that the first pass keeps the noise next to it.
TEST(Nfor, TheSecondPassRemovesNoiseNextToABrightWindow) {
    const Inputs inputs = synthetic_inputs(64, 48, 16, [](auto x, auto y, auto i) {
        CounterRandom random(mix(21), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
        const bool window = x >= 24 && x < 40 && y >= 16 && y < 32;
        SyntheticSample s;
        s.high.fill(static_cast<float>((window ? 200.0 : 1.0) * 2.0 * random.uniform()));
        return s;
    });
    const Planes picture = run_filter("nfor:blend=off", inputs).picture;
    const Planes& unfiltered = inputs.mean(frame::Channel::Radiance);
    double error = 0.0, before = 0.0;
    for (std::uint32_t y = 16; y < 32; ++y) {
        for (const std::uint32_t x : {21u, 22u, 41u, 42u}) {
            error += std::pow(picture.row(0, y)[x] - 1.0, 2);
            before += std::pow(unfiltered.row(0, y)[x] - 1.0, 2);
        }
    }
    EXPECT_LT(error / before, 0.1);  // the first pass alone: 2
}

TEST(Nfor, ABlackPictureStaysBlackAndOneBrightPixelStaysInItsWindow) {
    const auto lit = [](float dark, float bright, std::uint64_t n) {
        return synthetic_inputs(64, 48, n, [=](auto x, auto y, auto) {
            SyntheticSample s;
            s.high.fill(x == 32 && y == 24 ? bright : dark);
            return s;
        });
    };
    for (const std::uint64_t n : {1, 2, 3, 16}) {
        const Planes black = run_filter("nfor", lit(0.0f, 0.0f, n)).picture;
        for (std::size_t i = 0; i < 3 * black.pixel_count(); ++i) ASSERT_EQ(black.values()[i], 0.0f);
        const Planes picture = run_filter("nfor", lit(1e-3f, 1e6f, n)).picture;
        EXPECT_NEAR(picture.row(0, 0)[0], 1e-3f, 1e-5f) << n;
        for (const float v : picture.values()) ASSERT_TRUE(std::isfinite(v) && v >= 0.0f) << n;
    }
}

}  // namespace
}  // namespace tessera::filter
