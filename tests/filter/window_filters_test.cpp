// Cross-bilateral and edge-avoiding a-trous filters against their closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

constexpr std::uint32_t WindowSize = 65, Middle = 32;

// One bright pixel, or the values of `light`, on flat features or those of `change`.
Inputs picture_of(const std::function<float(std::uint32_t, std::uint32_t)>& light,
                  const std::function<void(SyntheticSample&, std::uint32_t, std::uint32_t)>& change = {}) {
    return synthetic_inputs(WindowSize, WindowSize, 2, [&](auto x, auto y, auto) {
        SyntheticSample s;
        if (change) change(s, x, y);
        s.high = s.irradiance = {light(x, y), light(x, y), light(x, y)};
        return s;
    });
}

Inputs impulse() {
    return picture_of([](auto x, auto y) { return x == Middle && y == Middle ? 1.0f : 0.0f; });
}

float step(std::uint32_t x, std::uint32_t) {
    return x < Middle ? 0.25f : 1.0f;
}

void expect_step_kept(const Output& out, const char* what) {
    for (std::uint32_t y = 0; y < WindowSize; ++y) {
        for (std::uint32_t x = 0; x < WindowSize; ++x) {
            ASSERT_NEAR(out.picture.row(0, y)[x], step(x, y), 1e-6f) << what << " at " << x << ", " << y;
        }
    }
}

// --- bilateral

TEST(Bilateral, IsAGaussWhereFeaturesAreFlat) {
    const Output out = run_filter("bilateral:sigma=2", impulse());
    double sum = 0.0;
    for (int i = -5; i <= 5; ++i) sum += std::exp(-i * i / 8.0);
    for (int dy = -6; dy <= 6; ++dy) {
        for (int dx = -6; dx <= 6; ++dx) {
            const bool inside = std::max(std::abs(dx), std::abs(dy)) <= 5;
            const double expected = inside ? std::exp(-(dx * dx + dy * dy) / 8.0) / (sum * sum) : 0.0;
            EXPECT_NEAR(out.picture.row(0, Middle + dy)[Middle + dx], expected, 1e-6) << dx << ", " << dy;
        }
    }
}

TEST(Bilateral, OneSigmaOfAFeatureWeighsAsOneSigmaOfDistance) {
    // Dark on the left, light on the right; the right differs by one sigma of a single feature.
    const auto light = [](auto x, auto) { return x < Middle ? 0.0f : 1.0f; };
    const std::array<std::function<void(SyntheticSample&, std::uint32_t, std::uint32_t)>, 3> features{
        [](SyntheticSample& s, auto x, auto) { s.albedo[1] = x < Middle ? 0.5f : 0.6f; },
        [](SyntheticSample& s, auto x, auto) {
            s.normal = {x < Middle ? 0.0f : 0.2f, 0.0f, 1.0f};
        },
        [](SyntheticSample& s, auto x, auto) { s.depth = x < Middle ? 3.0f : 3.0f * std::exp(0.3f); },
    };
    double left = 0.0, right = 0.0;
    for (int i = -5; i <= 5; ++i) (i <= 0 ? left : right) += std::exp(-i * i / 8.0);
    const double expected = std::exp(-0.5) * right / (left + std::exp(-0.5) * right);
    for (const auto& change : features) {
        const Output out = run_filter("bilateral:sigma=2,sigma_albedo=0.1,sigma_normal=0.2,sigma_depth=0.3",
                                      picture_of(light, change));
        EXPECT_NEAR(out.picture.row(0, Middle)[Middle - 1], expected, 1e-5);
    }
}

TEST(Bilateral, FarFeaturesDoNotMix) {
    expect_step_kept(
        run_filter("bilateral",
                   picture_of(step,
                              [](SyntheticSample& s, auto x, auto) {
                                  s.albedo = x < Middle ? std::array{0.2f, 0.2f, 0.2f} : s.albedo;
                              })),
        "albedo");
    expect_step_kept(
        run_filter("bilateral", picture_of(step,
                                           [](SyntheticSample& s, auto x, auto) {
                                               s.depth =
                                                   x < Middle ? std::numeric_limits<float>::infinity() : 2.0f;
                                           })),
        "background");
}

TEST(Bilateral, WeightsDoNotDependOnColour) {
    const auto light = [](auto x, auto y) {
        return std::exp(0.1f * static_cast<float>((x * 31 + y * 17) % 50));
    };
    const Output once = run_filter("bilateral", picture_of(light));
    const Output twice =
        run_filter("bilateral", picture_of([&](auto x, auto y) { return 2.0f * light(x, y); }));
    for (std::size_t i = 0; i < once.picture.pixel_count(); ++i) {
        ASSERT_EQ(2.0f * once.picture.plane(0)[i], twice.picture.plane(0)[i]);
    }
}

// --- eaw

TEST(Eaw, LevelsAreSplinesWhereNothingStopsThem) {
    const auto spline = [](int i) { return std::array{3.0 / 8, 1.0 / 4, 1.0 / 16}[std::abs(i)]; };
    const Output one = run_filter("eaw:levels=1,sigma_color=1000", impulse());
    const Output two = run_filter("eaw:levels=2,sigma_color=1000", impulse());
    for (int dy = -7; dy <= 7; ++dy) {
        for (int dx = -7; dx <= 7; ++dx) {
            const auto single = [&](int i) { return std::abs(i) <= 2 ? spline(i) : 0.0; };
            const auto twice = [&](int i) {
                double sum = 0.0;
                for (int j = -2; j <= 2; ++j) sum += spline(j) * single(i - 2 * j);
                return sum;
            };
            EXPECT_NEAR(one.picture.row(0, Middle + dy)[Middle + dx], single(dx) * single(dy), 2e-6);
            EXPECT_NEAR(two.picture.row(0, Middle + dy)[Middle + dx], twice(dx) * twice(dy), 2e-6);
        }
    }
}

TEST(Eaw, NoLevelsLeaveThePicture) {
    const Inputs inputs = picture_of(step);
    const Output out = run_filter("eaw:levels=0", inputs);
    for (std::size_t i = 0; i < out.picture.pixel_count(); ++i) {
        ASSERT_FLOAT_EQ(out.picture.plane(0)[i], inputs.color(0)[i]);
    }
}

TEST(Eaw, EdgesOfSurfacesAndStrongEdgesOfColourAreKept) {
    expect_step_kept(run_filter("eaw", picture_of(step,
                                                  [](SyntheticSample& s, auto x, auto) {
                                                      if (x < Middle) s.normal = {1.0f, 0.0f, 0.0f};
                                                  })),
                     "normal");
    expect_step_kept(run_filter("eaw", picture_of(step,
                                                  [](SyntheticSample& s, auto x, auto) {
                                                      if (x < Middle) s.depth = 4.0f;
                                                  })),
                     "depth");
    expect_step_kept(run_filter("eaw:sigma_color=0.02", picture_of(step)), "colour");
}

TEST(Eaw, TheExposureDoesNotMatter) {
    const auto light = [](auto x, auto y) {
        return 0.1f + 0.01f * static_cast<float>((x * 31 + y * 17) % 50);
    };
    const Output once = run_filter("eaw", picture_of(light));
    const Output brighter =
        run_filter("eaw", picture_of([&](auto x, auto y) { return 1024.0f * light(x, y); }));
    for (std::size_t i = 0; i < once.picture.pixel_count(); ++i) {
        ASSERT_EQ(1024.0f * once.picture.plane(0)[i], brighter.picture.plane(0)[i]);
    }
}

}  // namespace
}  // namespace tessera::filter
