// What a filter must not do: blur light across edges, show tiles, increase the error if it is declared consistent.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "mediator/base/random.h"
#include "tests/contract/filter_cases.h"

namespace tessera::filter::test {
namespace {

class FilterQuality : public FilterContract {};

double hit(double probability, std::uint64_t seed, std::uint32_t x, std::uint32_t y, std::uint64_t sample) {
    CounterRandom random(seed, mix((std::uint64_t{y} << 32 | x) ^ mix(sample)));
    return random.uniform() < probability ? 1.0 : 0.0;
}

SyntheticSample lit(double albedo, std::array<float, 3> normal, double depth, std::uint32_t object,
                    double light) {
    SyntheticSample s;
    const auto a = static_cast<float>(albedo), l = static_cast<float>(light);
    s.albedo = {a, a, a};
    s.normal = normal;
    s.depth = static_cast<float>(depth);
    s.object = object;
    s.high = {a * l, a * l, a * l};
    s.irradiance = {l, l, l};
    s.shading = l;
    const float facing = a * (1.0f + normal[2]) / 2.0f;
    s.headlight = {facing, facing, facing};
    return s;
}

// --- edges

struct Edge {
    std::string what;
    double left, right;  // radiance
    Sampler sampler;
};

constexpr std::uint32_t EdgeSize = 64, EdgeAt = 32;

// The same step of light at an edge of each kind of feature.
std::vector<Edge> edges() {
    constexpr std::array<float, 3> Facing{0.0f, 0.0f, 1.0f}, Tilted{0.8f, 0.0f, 0.6f};
    return {
        {"albedo", 0.2, 0.8,
         [=](auto x, auto y, auto i) {
             return lit(x < EdgeAt ? 0.25 : 1.0, Facing, 2.0, 1, hit(0.8, 31, x, y, i));
         }},
        {"normal", 0.2, 0.8,
         [=](auto x, auto y, auto i) {
             return lit(1.0, x < EdgeAt ? Facing : Tilted, 2.0, 1, hit(x < EdgeAt ? 0.2 : 0.8, 32, x, y, i));
         }},
        {"depth", 0.2, 0.8,
         [=](auto x, auto y, auto i) {
             return lit(1.0, Facing, x < EdgeAt ? 2.0 : 20.0, x < EdgeAt ? 1 : 2,
                        hit(x < EdgeAt ? 0.2 : 0.8, 33, x, y, i));
         }},
    };
}

double column_mean(const Planes& picture, std::uint32_t x) {
    double sum = 0.0;
    for (std::uint32_t y = 0; y < picture.height(); ++y) sum += picture.row(1, y)[x];
    return sum / picture.height();
}

// The largest fraction of the step that leaked across the edge, from the means of the adjacent columns; the mean of a
// whole column has little noise.
double leak(const Planes& picture, const Edge& edge) {
    double worst = 0.0;
    for (std::uint32_t d = 0; d < 4; ++d) {
        const double left = column_mean(picture, EdgeAt - 1 - d), right = column_mean(picture, EdgeAt + d);
        worst = std::max({worst, (left - edge.left) / (edge.right - edge.left),
                          (edge.right - right) / (edge.right - edge.left)});
    }
    return worst;
}

TEST_P(FilterQuality, LightStaysOnItsSideOfAnEdge) {
    if (is_one_of({"gauss"})) GTEST_SKIP() << "sees no edges, by its definition";
    for (const Edge& edge : edges()) {
        if (edge.what == "depth" && is_one_of({"oidn"})) continue;  // the stand-in sees albedo and normals
        const Inputs inputs = synthetic_inputs(EdgeSize, EdgeSize, 16, edge.sampler);
        Subject subject(entry(), inputs);
        EXPECT_LE(leak(subject.picture(inputs), edge), 0.1) << name() << " at an edge of " << edge.what;
    }
}

// Slope of the filtered picture over the true one, within the light's mean: 1 where texture is kept, 0 where
// it is blurred away.
double texture_kept(const Planes& picture, const Planes& truth) {
    double mean_out = 0.0, mean_true = 0.0, both = 0.0, own = 0.0;
    const double count = static_cast<double>(truth.pixel_count());
    for (std::size_t i = 0; i < truth.pixel_count(); ++i) {
        mean_out += picture.plane(1)[i] / count;
        mean_true += truth.plane(1)[i] / count;
    }
    for (std::size_t i = 0; i < truth.pixel_count(); ++i) {
        const double t = truth.plane(1)[i] - mean_true;
        both += (picture.plane(1)[i] - mean_out) * t;
        own += t * t;
    }
    return both / own;
}

TEST_P(FilterQuality, TextureIsKept) {
    if (is_one_of({"gauss"})) GTEST_SKIP() << "sees no texture, by its definition";
    const auto albedo = [](auto x, auto y) { return (x / 4 + y / 4) % 2 == 0 ? 0.3 : 0.8; };
    const Inputs inputs = synthetic_inputs(64, 64, 16, [&](auto x, auto y, auto i) {
        return lit(albedo(x, y), {0.0f, 0.0f, 1.0f}, 2.0, 1, hit(0.7, 34, x, y, i));
    });
    Planes truth(64, 64, 3);
    for (std::uint32_t y = 0; y < 64; ++y) {
        for (std::uint32_t x = 0; x < 64; ++x) {
            for (std::uint32_t c = 0; c < 3; ++c) truth.row(c, y)[x] = static_cast<float>(0.7 * albedo(x, y));
        }
    }
    Subject subject(entry(), inputs);
    EXPECT_GE(texture_kept(subject.picture(inputs), truth), 0.9) << name();
}

// --- seams

constexpr std::uint32_t Tile = 32, TilesPerSide = 6, SeamSize = Tile * TilesPerSide;

std::uint64_t samples_of_tile(std::uint32_t x, std::uint32_t y) {
    return std::uint64_t{4} << (mix(x / Tile + 97 * (y / Tile)) % 3);  // 4, 8 or 16
}

// A smooth surface in smooth light, whose tiles have different numbers of samples.
Inputs tiled_inputs() {
    return synthetic_inputs(SeamSize, SeamSize, 16, [](auto x, auto y, auto i) {
        if (i >= samples_of_tile(x, y)) return rejected();
        const double light = 0.4 + 0.2 * std::sin(0.02 * x) * std::cos(0.03 * y);
        return lit(0.8, {0.0f, 0.0f, 1.0f}, 2.0, 1, hit(light, 35, x, y, i));
    });
}

// Compares the squared gradient across each border of two tiles with those inside the two, as pairs: `step`
// for the mean along the border (a visible line), `noise` for single pixels. Student's t; 0 when tiles cannot
// be seen, positive when their borders are visible.
struct SeamStatistic {
    double step = 0.0, noise = 0.0;
};

double student(const std::vector<double>& differences) {
    const double n = static_cast<double>(differences.size());
    const double mean = std::accumulate(differences.begin(), differences.end(), 0.0) / n;
    double squares = 0.0;
    for (const double d : differences) squares += (d - mean) * (d - mean);
    return squares == 0.0 ? 0.0 : mean / std::sqrt(squares / (n - 1.0) / n);
}

SeamStatistic seams(const Planes& picture) {
    // Gradient across the line between column at - 1 and column `at` (or rows), along one tile.
    const auto line = [&](bool columns, std::uint32_t at, std::uint32_t along) {
        double sum = 0.0, squares = 0.0;
        for (std::uint32_t i = along * Tile; i < (along + 1) * Tile; ++i) {
            const double g = columns ? picture.row(1, i)[at] - picture.row(1, i)[at - 1]
                                     : picture.row(1, at)[i] - picture.row(1, at - 1)[i];
            sum += g;
            squares += g * g;
        }
        return std::array{(sum / Tile) * (sum / Tile), squares / Tile};
    };
    std::array<std::vector<double>, 2> differences;
    for (const bool columns : {true, false}) {
        for (std::uint32_t border = 1; border < TilesPerSide; ++border) {
            for (std::uint32_t along = 0; along < TilesPerSide; ++along) {
                const auto across = line(columns, border * Tile, along);
                for (std::size_t kind = 0; kind < 2; ++kind) {
                    double inside = 0.0;
                    for (std::uint32_t d = 8; d <= 24; d += 2) {
                        inside += (line(columns, border * Tile - d, along)[kind] +
                                   line(columns, border * Tile + d, along)[kind]) /
                                  18.0;
                    }
                    differences[kind].push_back(across[kind] - inside);
                }
            }
        }
    }
    return {student(differences[0]), student(differences[1])};
}

constexpr double SeamBound = 3.5;  // one in four thousand by chance, with 60 borders

TEST_P(FilterQuality, TilesDoNotShow) {
    const Inputs inputs = tiled_inputs();
    Subject subject(entry(), inputs);
    const SeamStatistic found = seams(subject.picture(inputs));
    EXPECT_LE(found.step, SeamBound) << name() << ": lines at the borders of tiles";
    EXPECT_LE(found.noise, SeamBound) << name() << ": stronger gradients at the borders of tiles";
}

TEST(FilterSeams, ABlurWithinTilesIsDetected) {
    const Inputs inputs = tiled_inputs();
    Planes blurred(SeamSize, SeamSize, 3);
    const auto radiance = inputs.color(1);
    for (std::uint32_t y = 0; y < SeamSize; ++y) {
        for (std::uint32_t x = 0; x < SeamSize; ++x) {
            double sum = 0.0, count = 0.0;
            for (std::uint32_t v = y / Tile * Tile; v < (y / Tile + 1) * Tile; ++v) {
                for (std::uint32_t u = x / Tile * Tile; u < (x / Tile + 1) * Tile; ++u) {
                    if (std::abs(int(u) - int(x)) > 4 || std::abs(int(v) - int(y)) > 4) continue;
                    sum += radiance[u + std::size_t{SeamSize} * v];
                    count += 1.0;
                }
            }
            blurred.row(1, y)[x] = static_cast<float>(sum / count);
        }
    }
    EXPECT_GT(seams(blurred).noise, SeamBound);
}

// --- consistency

// Mean of squared errors over squares of the true values; the 0.01 keeps black from counting without bound.
double relative_error(const Planes& picture, const Planes& truth) {
    double sum = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < truth.pixel_count(); ++i) {
            const double t = truth.plane(c)[i], d = picture.plane(c)[i] - t;
            sum += d * d / (t * t + 0.01);
        }
    }
    return sum / (3.0 * static_cast<double>(truth.pixel_count()));
}

TEST_P(FilterQuality, IsConsistentIfDeclaredSo) {
    if (!entry().description.consistent) GTEST_SKIP() << "is biased, and says so";
    constexpr std::uint32_t Width = 64, Height = 36;
    const Planes truth = shadowed_texture_truth(Width, Height);
    for (const std::uint64_t n : {4, 16, 64, 256, 1024}) {
        const Inputs inputs = synthetic_inputs(Width, Height, n, [](auto x, auto y, auto i) {
            return shadowed_texture(Width, Height, x, y, i);
        });
        Subject subject(entry(), inputs);
        Planes raw(Width, Height, 3);
        for (std::uint32_t c = 0; c < 3; ++c) std::ranges::copy(inputs.color(c), raw.plane(c).begin());
        const double ratio = relative_error(subject.picture(inputs), truth) / relative_error(raw, truth);
        EXPECT_LE(ratio, 1.05) << name() << " at " << n << " samples: error over that of the raw picture";
        RecordProperty("ratio_" + std::to_string(n), std::to_string(ratio));
    }
}

INSTANTIATE_TEST_SUITE_P(Catalog, FilterQuality, testing::Range<std::size_t>(0, catalog().size()),
                         filter_name);

}  // namespace
}  // namespace tessera::filter::test
