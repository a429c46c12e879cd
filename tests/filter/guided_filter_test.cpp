// The guided filter: its sums, its solver, the whole against the definition, and preservation of linear
// models.
#include <gtest/gtest.h>

#include <cmath>

#include "master/filter/box_sum.h"
#include "master/filter/guided/local_models.h"
#include "master/filter/guided/ridge.h"
#include "mediator/base/random.h"
#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

TEST(BoxSum, LargeValuesLeaveNoRoundingInSmallOnes) {
    constexpr std::size_t Size = 20, N = 11, Pitch = Size + N - 1;
    std::vector<float> values(Pitch * Pitch, 1e-3f), between(Size * Pitch), sums(Size * Size);
    values[2 * Pitch + 2] = 1e30f;
    box_sum(values.data(), Pitch, Size, Size, N, between.data(), sums.data());
    for (std::size_t y = 0; y < Size; ++y) {
        for (std::size_t x = 0; x < Size; ++x)
            ASSERT_NEAR(sums[y * Size + x] / (x <= 2 && y <= 2 ? 1e30 : 1e-3 * N * N), 1.0, 1e-5)
                << x << " " << y;
    }
}

TEST(BoxSum, EqualsTheSum) {
    constexpr std::size_t Width = 11, Height = 7;
    for (std::size_t n = 1; n <= 17; ++n) {
        const std::size_t pitch = Width + n - 1, rows = Height + n - 1;
        std::vector<float> values(pitch * rows), between(Width * rows), sums(Width * Height);
        CounterRandom random(n);
        for (float& value : values) value = static_cast<float>(random.uniform());
        std::vector<double> expected(Width * Height);
        for (std::size_t y = 0; y < Height; ++y) {
            for (std::size_t x = 0; x < Width; ++x) {
                for (std::size_t i = 0; i < n * n; ++i) {
                    expected[y * Width + x] += values[(y + i / n) * pitch + x + i % n];
                }
            }
        }
        box_sum(values.data(), pitch, Width, Height, n, between.data(), sums.data());
        for (std::size_t i = 0; i < sums.size(); ++i)
            ASSERT_NEAR(sums[i], expected[i], 1e-5 * expected[i]) << n;
    }
}

using Matrix = std::array<std::array<double, GuideCount>, GuideCount>;
using Vector = std::array<double, GuideCount>;

// Gauss' elimination, in double.
Vector solved(Matrix a, Vector b) {
    for (std::size_t j = 0; j < GuideCount; ++j) {
        for (std::size_t i = j + 1; i < GuideCount; ++i) {
            const double factor = a[i][j] / a[j][j];
            for (std::size_t k = j; k < GuideCount; ++k) a[i][k] -= factor * a[j][k];
            b[i] -= factor * b[j];
        }
    }
    for (std::size_t i = GuideCount; i-- > 0;) {
        for (std::size_t k = i + 1; k < GuideCount; ++k) b[i] -= a[i][k] * b[k];
        b[i] /= a[i][i];
    }
    return b;
}

TEST(GuidedRidge, SolvesSystemsSideBySide) {
    constexpr std::size_t Lanes = 8;
    Ridge<GuideCount, Lanes> ridge;
    std::array<std::array<float, Lanes>, GuideCount> right{};
    std::array<Matrix, Lanes> matrices{};
    std::array<Vector, Lanes> vectors{};
    CounterRandom random(3);
    for (std::size_t lane = 0; lane < Lanes; ++lane) {
        std::array<Vector, 12> samples;
        for (Vector& sample : samples) {
            for (double& value : sample) value = 2.0 * random.uniform() - 1.0;
        }
        for (std::size_t i = 0; i < GuideCount; ++i) {
            right[i][lane] = static_cast<float>(vectors[lane][i] = random.uniform());
            for (std::size_t j = 0; j < GuideCount; ++j) {
                for (const Vector& sample : samples) matrices[lane][i][j] += sample[i] * sample[j];
                if (j <= i) ridge.at(i, j)[lane] = static_cast<float>(matrices[lane][i][j]);
            }
            matrices[lane][i][i] += 0.1;
        }
    }
    ridge.factorise(0.1f);
    ridge.solve(right);
    for (std::size_t lane = 0; lane < Lanes; ++lane) {
        const Vector expected = solved(matrices[lane], vectors[lane]);
        for (std::size_t i = 0; i < GuideCount; ++i) EXPECT_NEAR(right[i][lane], expected[i], 1e-4);
    }
}

// He's two steps as published, in double, one component.
std::vector<double> by_definition(const Planes& guides, const Planes& color, const Planes& known, int radius,
                                  double ridge) {
    const int width = static_cast<int>(color.width()), height = static_cast<int>(color.height());
    const auto window = [&](int x, int y, const auto& body) {
        for (int v = std::max(y - radius, 0); v <= std::min(y + radius, height - 1); ++v) {
            for (int u = std::max(x - radius, 0); u <= std::min(x + radius, width - 1); ++u) body(u, v);
        }
    };
    std::vector<Vector> slopes(color.pixel_count());
    std::vector<double> constants(color.pixel_count()), out(color.pixel_count());
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double count = 0.0, mean = 0.0;
            Vector centre{}, product{};
            Matrix pairs{};
            window(x, y, [&](int u, int v) {
                if (known.row(0, v)[u] == 0.0f) return;
                const double c = color.row(0, v)[u];
                count += 1.0;
                mean += c;
                for (std::size_t i = 0; i < GuideCount; ++i) {
                    const double g = guides.row(i, v)[u];
                    centre[i] += g;
                    product[i] += g * c;
                    for (std::size_t j = 0; j < GuideCount; ++j) pairs[i][j] += g * guides.row(j, v)[u];
                }
            });
            mean /= count;
            for (double& value : centre) value /= count;
            for (std::size_t i = 0; i < GuideCount; ++i) {
                product[i] = product[i] / count - centre[i] * mean;
                for (std::size_t j = 0; j < GuideCount; ++j) {
                    pairs[i][j] = pairs[i][j] / count - centre[i] * centre[j] + (i == j ? ridge : 0.0);
                }
            }
            const std::size_t at = static_cast<std::size_t>(y * width + x);
            slopes[at] = solved(pairs, product);
            constants[at] = mean;
            for (std::size_t i = 0; i < GuideCount; ++i) constants[at] -= slopes[at][i] * centre[i];
        }
    }
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double sum = 0.0, count = 0.0;
            window(x, y, [&](int u, int v) {
                const std::size_t at = static_cast<std::size_t>(v * width + u);
                sum += constants[at];
                for (std::size_t i = 0; i < GuideCount; ++i) sum += slopes[at][i] * guides.row(i, y)[x];
                count += 1.0;
            });
            out[static_cast<std::size_t>(y * width + x)] = sum / count;
        }
    }
    return out;
}

TEST(GuidedModels, EqualTheDefinitionAcrossTilesAndStrips) {
    const std::uint32_t width = 75, height = 139;
    Planes guides(width, height, GuideCount), color(width, height, 3), known(width, height, 1),
        out(width, height, 3);
    CounterRandom random(8);
    for (float& value : guides.values()) value = static_cast<float>(3.0 * random.uniform() - 1.0);
    for (float& value : color.values()) value = static_cast<float>(random.uniform());
    for (float& value : known.values()) value = random.uniform() < 0.2 ? 0.0f : 1.0f;
    tbb::task_arena arena(2);
    RunContext context{arena, {}};
    LocalModels models;
    ASSERT_TRUE(models.run(guides, color, known, {.radius = 3, .ridge = 0.05f}, out, context));
    const std::vector<double> expected = by_definition(guides, color, known, 3, 0.05);
    double worst = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        worst = std::max(worst, std::abs(out.plane(0)[i] - expected[i]));
    }
    EXPECT_LT(worst, 2e-5);
}

TEST(Guided, KeepsLightLinearInTheFeatures) {
    // Light 0.7 on a random albedo; and light that rises along a slanted plane, whose disparity is linear in
    // x.
    const Inputs texture = synthetic_inputs(64, 64, 1, [](auto x, auto y, auto) {
        SyntheticSample s;
        const auto a = static_cast<float>(0.2 + 0.6 * CounterRandom(4, x + 64 * y).uniform());
        s.albedo = {a, a, a};
        s.high = {0.7f * a, 0.7f * a, 0.7f * a};
        return s;
    });
    const Output textured = run_filter("guided:epsilon=1e-5", texture);
    const Inputs slant = synthetic_inputs(64, 64, 1, [](auto x, auto, auto) {
        SyntheticSample s;
        s.depth = 10.0f / (1.0f + 0.05f * static_cast<float>(x));
        const float light = 0.1f + 0.01f * static_cast<float>(x);
        s.high = {light, light, light};
        return s;
    });
    const Output slanted = run_filter("guided:epsilon=1e-5", slant);
    for (std::size_t i = 0; i < texture.pixel_count(); ++i) {
        ASSERT_NEAR(textured.picture.plane(1)[i], texture.color(1)[i], 1e-4f) << i;
        ASSERT_NEAR(slanted.picture.plane(1)[i], slant.color(1)[i], 1e-3f) << i;
    }
}

TEST(Guided, ARampWithoutFeaturesIsKeptAwayFromTheBorders) {
    const Inputs inputs = synthetic_inputs(64, 64, 1, [](auto x, auto y, auto) {
        SyntheticSample s;
        s.high[0] = 0.1f + 0.01f * static_cast<float>(x) + 0.005f * static_cast<float>(y);
        return s;
    });
    const Output out = run_filter("guided", inputs);
    for (std::uint32_t y = 16; y < 48; ++y) {
        for (std::uint32_t x = 16; x < 48; ++x) {
            ASSERT_NEAR(out.picture.row(0, y)[x], inputs.color(0)[x + 64 * y], 2e-6f);
        }
    }
}

TEST(Guided, IsAMeanOfMeansWhereThereAreNoFeatures) {
    const Inputs inputs = synthetic_inputs(41, 41, 1, [](auto x, auto y, auto) {
        SyntheticSample s;
        s.high[0] = x == 20 && y == 20 ? 1.0f : 0.0f;
        return s;
    });
    const Output out = run_filter("guided:radius=3", inputs);
    for (int dy = -7; dy <= 7; ++dy) {
        for (int dx = -7; dx <= 7; ++dx) {
            const double expected =
                std::max(7 - std::abs(dx), 0) * std::max(7 - std::abs(dy), 0) / (49.0 * 49.0);
            EXPECT_NEAR(out.picture.row(0, 20 + dy)[20 + dx], expected, 1e-7) << dx << ", " << dy;
        }
    }
}

}  // namespace
}  // namespace tessera::filter
