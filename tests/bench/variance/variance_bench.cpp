#include "tests/bench/variance/variance_bench.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mediator/frame/design_effect.h"
#include "mediator/frame/resolve.h"
#include "tests/bench/filters/sampler.h"

namespace tessera::tools::bench {

namespace {

using frame::Channel;

constexpr std::uint32_t Edge = 16;
constexpr std::array Weights{0.2126, 0.7152, 0.0722};
constexpr double LeastError = 0.003;  // relative
// A 5 x 5 window is to expect three of the samples that cause the variance. If they are that rare, a block's own estimate
// of the variance of samples has a squared coefficient of variation of one over their number in the block.
constexpr double MostScatter = 25.0 / (3.0 * Edge * Edge);

// Sums over the seeds, for one number of samples.
struct Sums {
    std::vector<double> mean, square;              // of each pixel and component
    std::vector<std::vector<double>> stratified;   // estimates by seed and block
    std::vector<std::vector<double>> independent;  // the same by M2 / (n (n - 1))
};

class Blocks {
  public:
    explicit Blocks(Size size) : width_(size.width), across_(size.width / Edge), down_(size.height / Edge) {}
    std::size_t count() const { return std::size_t{across_} * down_; }

    // Mean over each block of a value of its pixels.
    template <class Value>
    std::vector<double> means(const Value& value) const {
        std::vector<double> result(count(), 0.0);
        for (std::uint32_t y = 0; y < down_ * Edge; ++y) {
            for (std::uint32_t x = 0; x < across_ * Edge; ++x)
                result[y / Edge * across_ + x / Edge] +=
                    value(std::size_t{y} * width_ + x) / double(Edge * Edge);
        }
        return result;
    }

  private:
    std::uint32_t width_, across_, down_;
};

double weighted(const frame::Image& image, std::size_t pixel) {
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) sum += Weights[c] * double(image.values[3 * pixel + c]);
    return sum;
}

void add(const frame::FilmTile& film, const Blocks& blocks, Sums& sums) {
    const frame::Image mean = frame::resolve(film, Channel::Radiance),
                       variance = frame::resolve_variance_of_mean(film, Channel::Radiance);
    frame::DesignEffect design_effect;
    const std::span<const float> effect = design_effect.measure(film);
    sums.mean.resize(mean.values.size(), 0.0);
    sums.square.resize(mean.values.size(), 0.0);
    for (std::size_t i = 0; i < mean.values.size(); ++i) {
        const double value = mean.values[i];
        sums.mean[i] += value;
        sums.square[i] += value * value;
    }
    sums.independent.push_back(blocks.means([&](std::size_t i) { return weighted(variance, i); }));
    sums.stratified.push_back(
        blocks.means([&](std::size_t i) { return weighted(variance, i) * double(effect[i]); }));
}

double mean_of(const std::vector<std::vector<double>>& by_seed, std::size_t block) {
    double sum = 0.0;
    for (const std::vector<double>& blocks : by_seed) sum += blocks[block];
    return sum / double(by_seed.size());
}

// Squared coefficient of variation over the seeds.
double scatter(const std::vector<std::vector<double>>& by_seed, std::size_t block) {
    const double mean = mean_of(by_seed, block);
    double sum = 0.0;
    for (const std::vector<double>& blocks : by_seed) sum += (blocks[block] - mean) * (blocks[block] - mean);
    return mean > 0.0 ? sum / double(by_seed.size() - 1) / (mean * mean) : 0.0;
}

double fraction_within(const std::vector<double>& ratios) {
    if (ratios.empty()) return 1.0;
    const auto is_within = [](double ratio) { return ratio >= 0.7 && ratio <= 2.0; };
    return double(std::ranges::count_if(ratios, is_within)) / double(ratios.size());
}

VarianceRow row_of(std::uint64_t spp, const Sums& sums, const Blocks& blocks) {
    const double seeds = double(sums.stratified.size());
    const auto means = blocks.means([&](std::size_t i) {
        double mean = 0.0;
        for (std::size_t c = 0; c < 3; ++c) mean += Weights[c] * sums.mean[3 * i + c] / seeds;
        return mean;
    });
    const auto truth = blocks.means([&](std::size_t i) {
        double variance = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double sum = sums.mean[3 * i + c];
            variance += Weights[c] * (sums.square[3 * i + c] - sum * sum / seeds) / (seeds - 1.0);
        }
        return variance;
    });
    VarianceRow row{.spp = spp};
    std::vector<double> ratios, all;
    double whole = 0.0, stratified = 0.0, independent = 0.0;
    for (std::size_t b = 0; b < blocks.count(); ++b) {
        whole += truth[b];
        stratified += mean_of(sums.stratified, b);
        independent += mean_of(sums.independent, b);
        if (!(std::sqrt(truth[b]) >= LeastError * means[b]) || !(truth[b] > 0.0)) continue;
        const bool is_rare = scatter(sums.independent, b) > MostScatter;
        ++(is_rare ? row.rare_blocks : row.blocks);
        for (const std::vector<double>& estimates : sums.stratified) {
            all.push_back(estimates[b] / truth[b]);
            if (!is_rare) ratios.push_back(all.back());
        }
    }
    row.whole = whole > 0.0 ? stratified / whole : 1.0;
    row.independent = whole > 0.0 ? independent / whole : 1.0;
    row.within_all = fraction_within(all);
    row.within = fraction_within(ratios);
    if (ratios.empty()) return row;
    std::ranges::sort(ratios);
    row.smallest = ratios.front();
    row.median = ratios[ratios.size() / 2];
    row.largest = ratios.back();
    return row;
}

}  // namespace

std::optional<VarianceScene> measure_variances(const BenchScene& scene, const VariancePlan& plan,
                                               tbb::task_arena& arena, const BenchProgress& progress,
                                               const std::stop_token& stop) {
    const Sampler sampler(scene, arena);
    const Blocks blocks(plan.size);
    std::vector<Sums> sums(plan.spp.size());
    for (std::uint32_t seed = 0; seed < plan.seeds; ++seed) {
        progress.say(scene.name + ": seed " + std::to_string(seed + 1) + " of " + std::to_string(plan.seeds));
        GrowingFilm film = sampler.film(sampler.view(plan.size.width, plan.size.height,
                                                     {Channel::Radiance, Channel::BlockVariance},
                                                     view::PathClass::Indirect, seed + 1));
        for (std::size_t i = 0; i < plan.spp.size(); ++i) {
            if (!sampler.grow(film, plan.spp[i], stop)) return std::nullopt;
            add(film.whole(), blocks, sums[i]);
        }
    }
    VarianceScene result{.name = scene.name, .rows = {}};
    for (std::size_t i = 0; i < plan.spp.size(); ++i)
        result.rows.push_back(row_of(plan.spp[i], sums[i], blocks));
    return result;
}

}  // namespace tessera::tools::bench
