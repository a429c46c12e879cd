#include "master/filter/statmc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "master/filter/convergence_blend.h"
#include "master/filter/far_holes.h"
#include "master/filter/kernels.h"
#include "master/filter/membership.h"
#include "master/filter/moderated_variance.h"
#include "master/filter/noise_correlation.h"
#include "master/filter/student.h"

namespace tessera::filter {

namespace {

using frame::Channel;

enum Parameters : std::size_t {
    Radius,
    Sigma,
    Confidence,
    Pooled,
    Albedo,
    Normal,
    Depth,
    FeatureNoise,
    Transform,
    UseConvergenceBlend
};
constexpr double RootTransform = 1.0;  // the choice of the transform

constexpr std::uint32_t PoolRadius = 3;

// The inputs of a pair's weight, per pixel. Features are scaled so that their squared difference is an
// exponent.
enum Pair : std::uint32_t {
    Mean,
    Variance = Mean + 3,
    Square = Variance + 3,
    Credit,
    Count,
    Known,
    Feature,
    Trust = Feature + 7,
    PairPlanes = Trust + 3,
};
// Albedo, normal and depth: the first of each, and the end.
constexpr std::array<std::uint32_t, 4> Groups{0, 3, 6, 7};
// Half width, in squared distance, of the shell of pairs near the limit of membership.
constexpr float Shell = 0.5f;
constexpr std::int64_t Chunk = 128;  // pixels of a row at a time: their planes stay in the first cache
using Sums = std::array<std::array<float, Chunk>, 6>;  // weight, shell, colours
constexpr float Miss = 1e3f;  // logarithm of an infinite depth: misses only match misses

class StatMc final : public Filter {
  public:
    Report run(const Inputs& inputs, const Values& values, Output& out, RunContext context) override {
        Report report;
        const std::uint32_t components = inputs.color_components();
        shape(out.picture, inputs, components);
        squares_.prepare(values[Confidence]);
        tested_ = Channel::Radiance;
        if (values[Transform] == RootTransform) {
            if (inputs.has(Channel::Root)) {
                tested_ = Channel::Root;
            } else {
                report.notes.push_back("without the channel root: means of radiance are compared");
            }
        }
        bool done = false;
        {
            PassTimer timer(report, "variance", ModeratedVariance::Bytes);
            done = moderated_.run(inputs, static_cast<float>(values[Pooled]), PoolRadius, context, tested_);
        }
        if (done) {
            PassTimer timer(report, "pairs", 4.0 * (15 + PairPlanes + 8 * 3 * 3));
            shape_pairs(inputs);
            shape(self_, inputs, 1);
            shape(reached_, inputs, 1);
            done = for_rows(context, inputs.height, [&](std::uint32_t y) { prepare_row(inputs, values, y); });
            const auto noise = static_cast<float>(values[FeatureNoise]);
            done = done &&
                   for_rows(context, inputs.height, [&](std::uint32_t y) { put_trust(inputs, noise, y); });
        }
        if (done && tested_ != Channel::Radiance) {
            PassTimer timer(report, "correlation", NoiseCorrelation::Bytes);
            done = correlation_.run(inputs, Channel::Radiance, tested_, PoolRadius, context);
        }
        if (done) {
            PassTimer timer(report, "average", 4.0 * (PairPlanes + 2 * components));
            done = for_rows(context, inputs.height,
                            [&](std::uint32_t y) { average_row(inputs, values, out.picture, y); });
        }
        if (done && values[UseConvergenceBlend] > 0.0) {
            PassTimer timer(report, "convergence blend", ConvergenceBlend::bytes_per_pixel(components));
            done = convergence_blend_.apply(inputs, Channel::Radiance, self_.plane(0), out.picture, context);
            if (done && out.wants_maps) out.maps = {{"blend", convergence_blend_.weights()}};
        }
        report.stopped = !done || !far_holes_.fill(reached_, out.picture, context);
        return report;
    }

  private:
    // A row's planes follow each other, an odd multiple of 64 bytes apart: at equal distances that are
    // multiples of a page they would evict each other from the cache.
    void shape_pairs(const Inputs& inputs) {
        pitch_ = (std::size_t{inputs.width} + 31) / 32 * 32 + 16;
        pairs_.resize(pitch_ * PairPlanes * inputs.height);
    }
    float* pair_row(std::uint32_t plane, std::uint32_t y) {
        return pairs_.data() + (std::size_t{y} * PairPlanes + plane) * pitch_;
    }

    void prepare_row(const Inputs& inputs, const Values& values, std::uint32_t y) {
        const std::uint32_t width = inputs.width;
        const float* counts = inputs.counts.row(0, y);
        const float* dof = moderated_.dof().row(0, y);
        float* square = pair_row(Square, y);
        float* credit = pair_row(Credit, y);
        float seen = -1.0f;  // neighbours mostly have equal counts
        for (std::uint32_t x = 0; x < width; ++x) {
            const bool hole = !(counts[x] > 0.0f);
            pair_row(Count, y)[x] = hole ? 0.0f : counts[x];
            pair_row(Known, y)[x] = hole ? 0.0f : 1.0f;
            if (hole) {
                square[x] = 1.0f;
                credit[x] = 0.0f;
            } else if (dof[x] == seen) {
                square[x] = square[x - 1];
                credit[x] = credit[x - 1];
            } else {
                square[x] = squares_(dof[x]);
                credit[x] = 2.0f * (square[x] - squares_(2.0f * dof[x]));
            }
            seen = hole ? -1.0f : dof[x];
        }
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float* mean = inputs.mean(tested_).row(c, y);
            const float* variance = moderated_.variance().row(c, y);
            std::copy(mean, mean + width, pair_row(Mean + c, y));
            for (std::uint32_t x = 0; x < width; ++x) {
                pair_row(Variance + c, y)[x] = counts[x] > 0.0f ? variance[x] : UnknownVariance;
            }
        }
        put_feature(inputs, Channel::Albedo, values[Albedo], Feature, y);
        put_feature(inputs, Channel::Normal, values[Normal], Feature + 3, y);
        put_depth(inputs, values[Depth], y);
    }

    void put_feature(const Inputs& inputs, Channel channel, double deviation, std::uint32_t at,
                     std::uint32_t y) {
        const float scale = static_cast<float>(1.0 / (std::sqrt(2.0) * deviation));
        for (std::uint32_t c = 0; c < 3; ++c) {
            float* to = pair_row(at + c, y);
            std::fill(to, to + inputs.width, 0.0f);
            if (!inputs.has(channel)) continue;
            const float* from = inputs.mean(channel).row(c, y);
            for (std::uint32_t x = 0; x < inputs.width; ++x) to[x] = scale * from[x];
        }
    }

    void put_depth(const Inputs& inputs, double deviation, std::uint32_t y) {
        const float scale = static_cast<float>(1.0 / (std::sqrt(2.0) * deviation));
        float* to = pair_row(Feature + 6, y);
        std::fill(to, to + inputs.width, 0.0f);
        if (!inputs.has(Channel::Depth)) return;
        const float* depth = inputs.mean(Channel::Depth).row(0, y);
        for (std::uint32_t x = 0; x < inputs.width; ++x) {
            to[x] = scale * (std::isfinite(depth[x]) ? std::log(std::max(depth[x], 1e-30f)) : Miss);
        }
    }

    // By what squared differences of the features of a pixel are multiplied, per group. A pixel at an edge sees its
    // surfaces in random proportions, so that the features of few samples match no neighbour: it would remain unfiltered,
    // a speck. The variance of the mean of such a feature is about that of 3 x 3 pixels over n; it is added to the
    // square of the deviation.
    void put_trust(const Inputs& inputs, float noise, std::uint32_t y) {
        const std::int64_t width = inputs.width;
        const float* counts = pair_row(Count, y);
        for (std::int64_t begin = 0; begin < width; begin += Chunk) {
            const std::int64_t end = std::min(begin + Chunk, width);
            for (std::size_t group = 0; group + 1 < Groups.size(); ++group) {
                std::array<float, Chunk> variance{};
                for (std::uint32_t f = Groups[group]; f < Groups[group + 1]; ++f) {
                    add_spatial_variance(f, begin, end, y, inputs, variance);
                }
                float* trust = pair_row(Trust + static_cast<std::uint32_t>(group), y);
                for (std::int64_t x = begin; x < end; ++x) {
                    const float of_mean =
                        noise * variance[static_cast<std::size_t>(x - begin)] / std::max(counts[x], 1.0f);
                    trust[x] = 1.0f / (1.0f + 2.0f * of_mean);
                }
            }
        }
    }

    // Of 3 x 3 pixels without holes, by differences to the middle: exact where they are equal.
    void add_spatial_variance(std::uint32_t feature, std::int64_t begin, std::int64_t end, std::uint32_t y,
                              const Inputs& inputs, std::array<float, Chunk>& variance) {
        const std::int64_t width = inputs.width, height = inputs.height;
        std::array<float, Chunk> count{}, sum{}, squares{};
        const float* own = pair_row(Feature + feature, y);
        for (std::int64_t row = std::max<std::int64_t>(y, 1) - 1; row < std::min<std::int64_t>(y + 2, height);
             ++row) {
            const float* other = pair_row(Feature + feature, static_cast<std::uint32_t>(row));
            const float* known = pair_row(Known, static_cast<std::uint32_t>(row));
            for (std::int64_t dx = -1; dx <= 1; ++dx) {
                const std::int64_t first = std::max(begin, -dx), last = std::min(end, width - dx);
                for (std::int64_t x = first; x < last; ++x) {
                    const auto at = static_cast<std::size_t>(x - begin);
                    const float difference = known[x + dx] * (other[x + dx] - own[x]);
                    count[at] += known[x + dx];
                    sum[at] += difference;
                    squares[at] += difference * difference;
                }
            }
        }
        for (std::size_t at = 0; at < static_cast<std::size_t>(end - begin); ++at) {
            const float n = std::max(count[at], 1.0f), mean = sum[at] / n;
            variance[at] += std::max(squares[at] / n - mean * mean, 0.0f);
        }
    }

    void average_row(const Inputs& inputs, const Values& values, Planes& picture, std::uint32_t y) {
        const std::int64_t width = inputs.width, height = inputs.height;
        const auto radius = static_cast<std::int64_t>(values[Radius]);
        const double slope = 0.5 / (values[Sigma] * values[Sigma]);
        const std::uint32_t components = picture.components();
        for (std::int64_t begin = 0; begin < width; begin += Chunk) {
            const std::int64_t end = std::min(begin + Chunk, width);
            Sums sums{};
            for (std::int64_t row = std::max<std::int64_t>(y - radius, 0);
                 row < std::min(y + radius + 1, height); ++row) {
                const std::int64_t dy = row - y;
                Sums line{};  // partial sums reduce rounding
                for (std::int64_t dx = -radius; dx <= radius; ++dx) {
                    const std::int64_t first = std::max(begin, -dx), last = std::min(end, width - dx);
                    if (first >= last) continue;
                    alignas(32) std::array<float, Chunk> weights;
                    const auto spatial = static_cast<float>(-slope * static_cast<double>(dx * dx + dy * dy));
                    weigh(pair_row(0, y) + first, pair_row(0, static_cast<std::uint32_t>(row)) + first + dx,
                          pitch_, spatial, last - first, weights.data(), line[0].data() + (first - begin),
                          line[1].data() + (first - begin));
                    for (std::uint32_t c = 0; c < components; ++c) {
                        const float* from = inputs.color(c).data() + row * width + first + dx;
                        float* to = line[c + 2].data() + (first - begin);
                        for (std::int64_t i = 0; i < last - first; ++i) {
                            to[i] += weights[static_cast<std::size_t>(i)] * from[i];
                        }
                    }
                }
                for (std::size_t i = 0; i < components + 2; ++i) {
                    for (std::size_t x = 0; x < Chunk; ++x) sums[i][x] += line[i][x];
                }
            }
            // How much the average F depends on the pixel's own mean m, dF/dm: through its weight, and
            // through the choice of members by m. A pair that enters or leaves at the limit d = r moves F by
            // its weight times r; with the density of d taken from the shell, dF/dm = (own + shell / Shell) /
            // sum. The second term holds if m decides; if its root does, it is multiplied by their correlation twice: that
            // of the root with m, and of the difference of two pixels at the limit with that of their roots.
            for (std::int64_t x = begin; x < end; ++x) {
                const auto at = static_cast<std::size_t>(x - begin);
                const float share = tested_ == Channel::Radiance ? 1.0f : correlation_.squared().row(0, y)[x];
                const float own = pair_row(Count, y)[x] + share * sums[1][at] / Shell;
                self_.row(0, y)[x] = sums[0][at] > 0.0f ? std::min(own / sums[0][at], 1.0f) : 0.0f;
                reached_.row(0, y)[x] = sums[0][at] > 0.0f ? 1.0f : 0.0f;
            }
            for (std::uint32_t c = 0; c < components; ++c) {
                const float* own = inputs.color(c).data() + std::size_t{y} * inputs.width;
                float* to = picture.row(c, y);
                for (std::int64_t x = begin; x < end; ++x) {
                    const auto at = static_cast<std::size_t>(x - begin);
                    to[x] = sums[0][at] > 0.0f ? sums[c + 2][at] / sums[0][at] : own[x];
                }
            }
        }
    }

    // Weights of `count` pairs; the planes of p and q start at these pointers, `plane` floats apart. `shell`
    // sums those near the limit of membership: if m_p moves by e, pairs within e of the limit enter or leave.
    static void weigh(const float* p, const float* q, std::size_t plane, float spatial, std::int64_t count,
                      float* __restrict weights, float* __restrict sum, float* __restrict shell) {
        for (std::int64_t i = 0; i < count; ++i) {
            const auto of_p = [&](std::uint32_t which) {
                return p[which * plane + static_cast<std::size_t>(i)];
            };
            const auto of_q = [&](std::uint32_t which) {
                return q[which * plane + static_cast<std::size_t>(i)];
            };
            const auto square = [&](std::uint32_t f) {
                const float d = of_p(Feature + f) - of_q(Feature + f);
                return d * d;
            };
            const auto trust = [&](std::uint32_t group) {
                const float a = of_p(Trust + group), b = of_q(Trust + group);
                return a < b ? a : b;
            };
            const float distance = trust(0) * (square(0) + square(1) + square(2)) +
                                   trust(1) * (square(3) + square(4) + square(5)) + trust(2) * square(6);
            const Quantile quantile_p{of_p(Square), of_p(Credit)}, quantile_q{of_q(Square), of_q(Credit)};
            bool member = true, inner = true, outer = true;
            for (std::uint32_t c = 0; c < 3; ++c) {
                const float d = of_p(Mean + c) - of_q(Mean + c);
                const float limit =
                    squared_interval(of_p(Variance + c), of_q(Variance + c), quantile_p, quantile_q);
                member &= d * d <= limit;
                inner &= d * d <= (1.0f - Shell) * limit;
                outer &= d * d <= (1.0f + Shell) * limit;
            }
            const float weight = of_q(Count) * exp_negative(spatial - of_p(Known) * distance);
            weights[i] = member ? weight : 0.0f;
            sum[i] += member ? weight : 0.0f;
            shell[i] += outer && !inner ? weight : 0.0f;
        }
    }

    Channel tested_ = Channel::Radiance;
    ModeratedVariance moderated_;
    NoiseCorrelation correlation_;
    StudentSquares squares_;
    ConvergenceBlend convergence_blend_;
    std::vector<float> pairs_;  // by row, then by Pair
    std::size_t pitch_ = 0;
    Planes self_, reached_;
    FarHoles far_holes_;
};

}  // namespace

FilterEntry statmc_entry() {
    return {
        {.name = "statmc",
         .summary = "averages pixels with statistically indistinguishable means (confidence intervals)",
         .source = "Sakai et al. 2024",
         .bytes_per_pixel = 308,
         .parameters =
             {{"radius", "px", "radius of the square window (20 in the paper)", 10, 1, 40, {}},
              {"sigma", "px", "standard deviation of the spatial weight (10 in the paper)", 5, 0.1, 100, {}},
              {"confidence",
               "",
               "of the interval of the difference of two means, per channel",
               0.995,
               0.5,
               0.99999,
               {}},
              {"pooled",
               "",
               "degrees of freedom that the neighbourhood adds to a pixel's variance",
               4,
               0,
               64,
               {}},
              {"albedo", "", "standard deviation of the weight of albedo", 0.02, 1e-3, 10, {}},
              {"normal", "", "standard deviation of the weight of normals", 0.1, 1e-3, 10, {}},
              {"depth",
               "",
               "standard deviation of the weight of depth, relative to depth; not in the paper",
               0.1,
               1e-3,
               10,
               {}},
              {"feature_noise",
               "",
               "variance of features that is expected: times that of 3x3 pixels over the samples",
               2,
               0,
               100,
               {}},
              {"transform",
               "",
               "what the intervals compare: means of radiance, or of its root (Box-Cox transform)",
               RootTransform,
               0,
               1,
               {"none", "root"}},
              {"blend",
               "",
               "blend back to the samples where filtering would increase the error",
               1,
               0,
               1,
               {"off", "on"}}},
         .channels =
             [](const Values& values) {
                 frame::ChannelSet read{Channel::Radiance, Channel::Albedo, Channel::Normal, Channel::Depth};
                 if (values[Transform] == RootTransform) read.insert(Channel::Root);
                 return read;
             },
         .consistent = true,
         .reads_variances = true},
        [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> { return std::make_unique<StatMc>(); }};
}

}  // namespace tessera::filter
