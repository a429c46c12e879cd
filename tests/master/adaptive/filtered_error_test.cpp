#include "master/render/adaptive/filtered_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "master/filter/catalog.h"
#include "mediator/base/random.h"
#include "mediator/filter/inputs.h"
#include "mediator/picture/metrics.h"
#include "tests/filter/synthetic.h"

namespace tessera::master {
namespace {

constexpr std::uint32_t Width = 64, Height = 48;

filter::Choice choice_of(const std::string& text) {
    return filter::parse_choice(text, filter::catalog()).value();
}

struct FilteredErrors : testing::Test {
    tbb::task_arena arena{2};

    static frame::FilmTile film(std::uint64_t n, std::uint64_t seed, float scale = 1.0f) {
        return filter::synthetic_film(Width, Height, n, filter::EveryChannel,
                                      [=](std::uint32_t x, std::uint32_t y, std::uint64_t sample) {
                                          filter::SyntheticSample value =
                                              filter::shadowed_texture(Width, Height, x, y, sample, seed);
                                          for (auto* part : {&value.low, &value.high}) {
                                              for (float& component : *part) component *= scale;
                                          }
                                          return value;
                                      });
    }
    double estimate(const std::string& filter, const frame::FilmTile& of) {
        return FilteredError(of, filter::synthetic_view(Width, Height), choice_of(filter), arena).relmse();
    }
    static double truth(const std::string& filter, const frame::FilmTile& of) {
        const auto inputs = filter::make_inputs(of, filter::synthetic_view(Width, Height));
        const frame::Image all = interleaved(filter::run_filter(filter, inputs).picture);
        frame::Image picture(all.width, all.height, 3);
        const std::size_t components = all.values.size() / (all.width * all.height);
        for (std::size_t i = 0; i < picture.values.size(); ++i)
            picture.values[i] = all.values[i / 3 * components + i % 3];
        return picture::relmse(picture, interleaved(filter::shadowed_texture_truth(Width, Height)));
    }
};

// Of those that blur the dark half of a checker, whose error is nearly all bias relative to black, and of those that keep it.
TEST_F(FilteredErrors, AreTrueOfEachFilter) {
    for (const char* filter : {"gauss", "bilateral", "guided", "nlm", "fdf"}) {
        for (const std::uint64_t n : {16u, 64u}) {
            double estimated = 0.0, true_error = 0.0;
            for (std::uint64_t seed = 1; seed <= 8; ++seed) {
                const frame::FilmTile of = film(n, 100 * seed);
                estimated += estimate(filter, of);
                true_error += truth(filter, of);
            }
            std::printf("%s, %d samples: true error %.5f, %.2f times the estimate\n", filter, int(n),
                        true_error / 8.0, true_error / estimated);
            const bool keeps_edges = std::string_view(filter) == "nlm" || std::string_view(filter) == "fdf";
            EXPECT_GT(true_error / estimated, 0.6) << filter << ", " << n;
            EXPECT_LT(true_error / estimated, keeps_edges ? 1.6 : 3.5) << filter << ", " << n;
        }
    }
}

// The variance of filtered pictures falls with the size of the kernel, that of bias does not.
TEST_F(FilteredErrors, ContainBias) {
    const frame::FilmTile of = film(256, 7);
    EXPECT_GT(estimate("gauss:sigma=6", of), 4.0 * estimate("gauss:sigma=0.5", of));
}

TEST_F(FilteredErrors, DoNotDependOnTheUnitOfLight) {
    const double one = estimate("fdf", film(16, 3));
    for (const float scale : {1e-6f, 1e6f}) EXPECT_NEAR(estimate("fdf", film(16, 3, scale)) / one, 1.0, 1e-3);
}

TEST_F(FilteredErrors, AreFiniteWithoutLightAndWithHoles) {
    EXPECT_EQ(estimate("fdf", film(16, 3, 0.0f)), 0.0);
    const auto with_hole = [&](std::uint64_t n) {
        frame::FilmTile of = film(n, 3);
        for (std::size_t i = 0; i < of.pixel_count() / 2; ++i) {
            of.counts[i] = 0;
            for (std::uint32_t plane = 0; plane < of.channels.plane_count(); ++plane)
                of.plane(plane)[i] = 0.0f;
        }
        return of;
    };
    const double known = estimate("gauss", film(16, 3)), half = estimate("gauss", with_hole(16));
    EXPECT_GT(half, 0.2 * known);
    EXPECT_LT(half, 5.0 * known);
    EXPECT_TRUE(std::isfinite(estimate("fdf", with_hole(1))));
    frame::FilmTile bright = film(16, 3);
    const std::uint32_t plane = bright.channels.first_plane(frame::Channel::Radiance);
    for (std::uint32_t c = 0; c < 3; ++c) bright.plane(plane + c)[100] = 1e18f;
    EXPECT_TRUE(std::isfinite(estimate("fdf", bright)));
}

// All pixels are as noisy, but on the right no two have the same surface.
TEST_F(FilteredErrors, SendSamplesToWhatTheFilterLeavesNoisy) {
    const frame::FilmTile of = filter::synthetic_film(
        Width, Height, 16, filter::EveryChannel, [](std::uint32_t x, std::uint32_t y, std::uint64_t sample) {
            filter::SyntheticSample value;
            CounterRandom light(y * Width + x, sample), surface(9, y * Width + x);
            value.high.fill(0.5f + light.uniform());
            if (x >= Width / 2) {
                const float angle = 6.28f * surface.uniform();
                value.normal = {std::cos(angle), std::sin(angle), 0.0f};
            }
            return value;
        });
    view::View view = filter::synthetic_view(Width, Height);
    view.filter = "bilateral";
    const std::vector<Rect> tiles{{0, 0, Width / 2, Height}, {Width / 2, 0, Width / 2, Height}};
    const double error = estimate("bilateral", of);
    const Step step = next_step_to({view, 0.7 * error}, of, std::vector<std::uint8_t>(of.pixel_count(), 4),
                                   tiles, {.max_samples = 1024}, arena);
    ASSERT_EQ(step.rounds.size(), 1u);
    const auto& masks = *step.rounds.front().masks;
    EXPECT_GT(masks[1].pixels, 4 * masks[0].pixels);
}

TEST_F(FilteredErrors, OfAGoalEndItsSteps) {
    EXPECT_EQ(part_to_reach(0.1, 0.1), 1.0);
    EXPECT_EQ(part_to_reach(0.1, 0.05), 1.0);
    EXPECT_EQ(part_to_reach(0.1, 0.1001), 0.9) << "a step leads somewhere";
    EXPECT_LT(part_to_reach(0.1, 0.2), 0.5);
    EXPECT_GT(part_to_reach(0.1, 0.2), 0.4);

    const frame::FilmTile of = film(16, 3);
    view::View view = filter::synthetic_view(Width, Height);
    const std::vector<std::uint8_t> doublings(of.pixel_count(), 4);
    const std::vector<Rect> tiles{of.rect};
    const auto next = [&](const char* filter, double error) {
        view.filter = filter;
        return next_step_to({view, error}, of, doublings, tiles, {.max_samples = 1024}, arena);
    };
    const double error = estimate("fdf", of);
    EXPECT_EQ(next("fdf", 0.5 * error).error, error);
    EXPECT_FALSE(next("fdf", 0.5 * error).rounds.empty());
    EXPECT_TRUE(next("fdf", 1.01 * error).rounds.empty());
    EXPECT_EQ(next("fdf", 1.01 * error).samples_expected, 16u * of.pixel_count()) << "it has ended";
    // Without a filter it is the noise.
    const Step unfiltered = next("", 1e-4);
    EXPECT_EQ(unfiltered.error, unfiltered.noise * unfiltered.noise);
    EXPECT_FALSE(unfiltered.rounds.empty());
    EXPECT_TRUE(next("none", 1.01 * unfiltered.error).rounds.empty());
    EXPECT_FALSE(next("none", 0.99 * unfiltered.error).rounds.empty());
    // Fewer samples for a larger error.
    const auto samples = [](const Step& step) {
        std::size_t sum = 0;
        for (const Round& round : step.rounds) sum += round.masks->front().pixels;
        return sum;
    };
    EXPECT_LT(samples(next("fdf", 0.95 * error)), samples(next("fdf", 0.5 * error)));
}

}  // namespace
}  // namespace tessera::master
