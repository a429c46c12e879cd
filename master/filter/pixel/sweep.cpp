#include "master/filter/pixel/sweep.h"

#include <utility>

#include "master/filter/pixel/edge_model.h"
#include "master/filter/pixel/widths.h"

namespace tessera::filter::pixel {

namespace {

constexpr float HalfLog2E = 0.5f * 1.44269504f;

struct Line {
    std::int64_t first, last;      // steps that stay within the picture
    std::ptrdiff_t stride;         // floats per step
    std::ptrdiff_t before, after;  // floats to the neighbours across
};

// Replaces the two-sided filter by the mixture of two one-sided ones as far as the edge model is believed
// (Schwenk 3.19, 3.20). r is an upper bound: squares of mixtures are convex in belief, and the two sides
// share but the pixel itself, which is unlike at least one of them.
template <std::size_t Features, std::size_t Layers>
void recover_edges(const Neighbourhood<Features, Layers>& from, const std::array<Lanes, Features>& target,
                   Lanes spread, std::int64_t first, std::int64_t last, const Line& line,
                   Result<Layers>& result) {
    const EdgeModel<Features> model =
        edge_model<Features>(from.sources, target, line.stride, line.before, line.after);
    if (largest(model.belief) < 0.01f) return;
    Sums<Layers> low, high;
    gather(from, model.low, spread, 0.0f, first, -1, 1, line.stride, low);
    gather(from, model.high, spread, 0.0f, 1, last, 1, line.stride, high);
    // Without the pixel itself both sides must have found something that looks like them.
    const Lanes found = smaller(low.weight, high.weight);
    const Lanes belief = found > 0.05f ? model.belief : Lanes{};
    gather(from, model.low, spread, 0.0f, 0, 0, 1, line.stride, low);
    gather(from, model.high, spread, 0.0f, 0, 0, 1, line.stride, high);
    const Result<Layers> one = normalised(low), two = normalised(high);
    const Lanes a = model.coverage, b = 1.0f - model.coverage;
    for (std::size_t k = 0; k < Layers; ++k) {
        const Lanes edge = b * one.values[k] + a * two.values[k];
        result.values[k] += belief * (edge - result.values[k]);
    }
    const Lanes edge = b * b * one.reduction + a * a * two.reduction;
    result.reduction += belief * (edge - result.reduction);
}

constexpr std::uint32_t Stripe = 128;  // columns; their rows of all planes stay in the second-level cache

template <std::size_t Features, std::size_t Layers>
bool sweep_as(const Guide& guide, const Widths& widths, const Sweep& plan, const Field& from, Field& to,
              RunContext& context) {
    const auto width = static_cast<std::int64_t>(from.values.width());
    const auto height = static_cast<std::int64_t>(from.values.height());
    const auto pitch = static_cast<std::ptrdiff_t>(guide.pitch());
    const bool rows = plan.direction == Direction::Rows;

    const auto filter_block = [&](std::uint32_t y, std::int64_t x) {
        const auto near = neighbourhood<Features, Layers>(guide, plan.sources, from, y, x);
        const auto target = target_of<Features>(guide, y, x);
        const Lanes sigma = larger(load(widths.row(0, y) + x) * plan.width_factor, splat(1e-3f));
        const Lanes spread = HalfLog2E / (sigma * sigma);
        const auto radius = static_cast<std::int64_t>(3.0f * largest(sigma));
        const Line line = rows ? Line{.first = -(x + LaneCount - 1),
                                      .last = width - 1 - x,
                                      .stride = 1,
                                      .before = y > 0 ? -pitch : 0,
                                      .after = y + 1 < height ? pitch : 0}
                               : Line{.first = -std::int64_t{y},
                                      .last = height - 1 - y,
                                      .stride = pitch,
                                      .before = -1,
                                      .after = 1};
        const std::int64_t first = -std::min(radius, -line.first) / plan.spacing * plan.spacing;
        const std::int64_t last = std::min(radius, line.last) / plan.spacing * plan.spacing;

        Sums<Layers> sums;
        gather(near, target, spread, 0.0f, first, last, plan.spacing, line.stride, sums);
        Result<Layers> result = normalised(sums);
        if (plan.edges == Edges::Recover && first < 0 && last > 0) {
            recover_edges(near, target, spread, first, last, line, result);
        }
        keep_or_store(sums, near, result, y, x, to);
    };

    if (rows) {
        return for_rows(context, static_cast<std::uint32_t>(height), [&](std::uint32_t y) {
            for (std::int64_t x = 0; x < width; x += LaneCount) filter_block(y, x);
        });
    }
    const auto stripes = static_cast<std::uint32_t>((width + Stripe - 1) / Stripe);
    return for_rows(context, stripes * static_cast<std::uint32_t>(height), [&](std::uint32_t i) {
        const std::int64_t start = std::int64_t{i / static_cast<std::uint32_t>(height)} * Stripe;
        const std::int64_t end = std::min(width, start + Stripe);
        for (std::int64_t x = start; x < end; x += LaneCount) {
            filter_block(i % static_cast<std::uint32_t>(height), x);
        }
    });
}

}  // namespace

bool sweep(const Guide& guide, const Widths& widths, const Sweep& plan, const Field& from, Field& to,
           RunContext& context) {
    return with_shapes(guide, from, [&](auto features, auto layers) {
        return sweep_as<features(), layers()>(guide, widths, plan, from, to, context);
    });
}

bool filter_separable(const Guide& guide, const Widths& widths, int iterations, Edges edges, Field& field,
                      Field& scratch, RunContext& context) {
    Direction direction = Direction::Rows;
    Sources sources = Sources::Samples;
    for (int k = 1; k <= iterations; ++k) {
        const auto factor = static_cast<float>(iteration_sigma(1.0, k, iterations));
        for (int half = 0; half < 2; ++half) {
            if (!sweep(guide, widths, {direction, factor, 1, sources, edges}, field, scratch, context))
                return false;
            std::swap(field.values, scratch.values);
            // Only the first iteration's r is kept.
            if (k == 1) std::swap(field.reduction, scratch.reduction);
            if (half == 0) direction = direction == Direction::Rows ? Direction::Columns : Direction::Rows;
            sources = Sources::All;
        }
    }
    return true;
}

}  // namespace tessera::filter::pixel
