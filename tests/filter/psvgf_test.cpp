// Progressive SVGF on pictures that stand still (Dundr 2, tests DT of the notes).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

constexpr std::uint32_t Width = 96, Height = 54;

Inputs shadows(std::uint64_t n, std::uint64_t seed = 1) {
    Inputs inputs = synthetic_inputs(Width, Height, n, [seed](auto x, auto y, auto i) {
        return shadowed_texture(Width, Height, x, y, i, seed);
    });
    inputs.path_class = view::PathClass::Diffuse;
    return inputs;
}

// L37's measure: squared error by the square of the truth.
double relative_error(const Planes& picture, const Planes& truth) {
    double sum = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < truth.pixel_count(); ++i) {
            const double t = truth.plane(c)[i], d = picture.plane(c)[i] - t;
            sum += d * d / (t * t + 1e-2);
        }
    }
    return sum / static_cast<double>(3 * truth.pixel_count());
}

TEST(Psvgf, IsConsistent) {
    const Planes truth = shadowed_texture_truth(Width, Height);
    for (const std::uint64_t n : {4u, 8u, 16u, 32u, 64u, 128u, 256u, 512u, 1024u}) {
        const Inputs inputs = shadows(n);
        const double unfiltered = relative_error(run_filter("none", inputs).picture, truth);
        const double filtered = relative_error(run_filter("psvgf", inputs).picture, truth);
        EXPECT_LE(filtered, 1.05 * unfiltered) << n;
        if (n <= 16) {
            EXPECT_LE(filtered, 0.25 * unfiltered) << n;
        }
    }
}

}  // namespace
}  // namespace tessera::filter
