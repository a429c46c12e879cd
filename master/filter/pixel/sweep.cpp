#include "master/filter/pixel/sweep.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

#include "master/filter/pixel/edge_model.h"
#include "master/filter/pixel/widths.h"

namespace tessera::filter::pixel {

namespace {

constexpr float HalfLog2E = 0.5f * 1.44269504f;

// Offsets in floats to the next pixel in the direction of the sweep, and to its two neighbours across.
struct Across {
    std::ptrdiff_t stride, before, after;
};

struct Steps {
    std::int64_t first, last;
};

// The same means of other weight, so that a mixture with others is one of the means and not of their samples.
template <std::size_t Layers>
void set_weight(Pack weight, Result<Layers>& result) {
    // 0 where there are no similar neighbours.
    const Pack factor = weight / max(result.values[Layers - 1], all(1e-18f));
    for (Pack& value : result.values) value *= factor;
    result.reduction *= factor * factor;
}

// Replaces the two-sided filter by the mixture of two one-sided ones in proportion to the belief in the edge
// model (Schwenk 3.19, 3.20). r is an upper bound: squares of mixtures are convex in belief, and the two
// sides have only the pixel itself in common, which differs from at least one of them.
template <std::size_t Features, std::size_t Layers>
void recover_edges(const Neighbourhood<Features, Layers>& from, const std::array<Pack, Features>& target,
                   Pack spread, Steps steps, const Across& line, bool weighted, Result<Layers>& result) {
    const EdgeModel<Features> model =
        edge_model<Features>(from.sources, target, line.stride, line.before, line.after);
    if (largest(model.belief) < 0.01f) return;
    Sums<Layers> low, high;
    gather(from, model.low, spread, 0.0f, steps.first, -1, 1, line.stride, low);
    gather(from, model.high, spread, 0.0f, 1, steps.last, 1, line.stride, high);
    // Both sides must have similar neighbours, not counting the pixel itself.
    const Pack found = min(low.weight, high.weight);
    const Pack belief = found > 0.05f ? model.belief : Pack{};
    gather(from, model.low, spread, 0.0f, 0, 0, 1, line.stride, low);
    gather(from, model.high, spread, 0.0f, 0, 0, 1, line.stride, high);
    Result<Layers> one = normalised(low), two = normalised(high);
    if (weighted) {
        set_weight(result.values[Layers - 1], one);
        set_weight(result.values[Layers - 1], two);
    }
    const Pack a = model.coverage, b = 1.0f - model.coverage;
    for (std::size_t k = 0; k < Layers; ++k) {
        const Pack edge = b * one.values[k] + a * two.values[k];
        result.values[k] += belief * (edge - result.values[k]);
    }
    const Pack edge = b * b * one.reduction + a * a * two.reduction;
    result.reduction += belief * (edge - result.reduction);
}

// The extent of the kernels of eight pixels, clipped to the picture.
Steps steps_of(Pack sigma, const Sweep& plan, std::int64_t before, std::int64_t behind) {
    const auto radius = static_cast<std::int64_t>(3.0f * largest(sigma));
    return {-std::min(radius, before) / plan.spacing * plan.spacing,
            std::min(radius, behind) / plan.spacing * plan.spacing};
}

Pack sigma_at(const Widths& widths, const Sweep& plan, std::uint32_t y, std::int64_t x) {
    return max(load(widths.row(0, y) + x) * plan.width_factor, all(1e-3f));
}

template <std::size_t Features, std::size_t Layers>
void filter_block(const Neighbourhood<Features, Layers>& near, const std::array<Pack, Features>& target,
                  Pack sigma, Steps steps, const Sweep& plan, const Across& across, std::uint32_t y,
                  std::int64_t x, Field& to) {
    const Pack spread = HalfLog2E / (sigma * sigma);
    Sums<Layers> sums;
    gather(near, target, spread, 0.0f, steps.first, steps.last, plan.spacing, across.stride, sums);
    Result<Layers> result = normalised(sums);
    if (plan.edges == Edges::Recover && steps.first < 0 && steps.last > 0) {
        recover_edges(near, target, spread, steps, across, to.weighted, result);
    }
    keep_or_store(sums, near, result, y, x, to);
}

template <std::size_t Features, std::size_t Layers>
bool sweep_rows(const Guide& guide, const Widths& widths, const Sweep& plan, const Field& from, Field& to,
                RunContext& context) {
    const auto width = static_cast<std::int64_t>(from.values.width());
    const std::uint32_t height = from.values.height();
    const auto pitch = static_cast<std::ptrdiff_t>(guide.pitch());
    return for_rows(context, height, [&](std::uint32_t y) {
        const Across across{1, y > 0 ? -pitch : 0, y + 1 < height ? pitch : 0};
        for (std::int64_t x = 0; x < width; x += BlockWidth) {
            const Pack sigma = sigma_at(widths, plan, y, x);
            const Steps steps = steps_of(sigma, plan, x + BlockWidth - 1, width - 1 - x);
            const auto near = neighbourhood<Features, Layers>(guide, plan.sources, from, y, x);
            const auto target = target_of<Features>(guide, y, x);
            filter_block(near, target, sigma, steps, plan, across, y, x, to);
        }
    });
}

// Columns are read from copies of small strips with contiguous rows: in the picture itself each row of each
// plane is on a different page, more pages than the TLB holds.
constexpr std::int64_t StripWidth = 32, StripHeight = 128, StripBorder = BlockWidth;
constexpr std::int64_t StripPitch = StripWidth + 2 * StripBorder;

template <std::size_t Features, std::size_t Layers>
void sweep_strip(const Guide& guide, const Widths& widths, const Sweep& plan, const Field& from, Field& to,
                 std::int64_t left, std::int64_t top, std::vector<float>& copy) {
    const auto width = static_cast<std::int64_t>(from.values.width());
    const auto height = static_cast<std::int64_t>(from.values.height());
    const std::int64_t right = std::min(width, left + StripWidth);
    const std::int64_t bottom = std::min(height, top + StripHeight);
    Pack widest{};
    for (std::int64_t y = top; y < bottom; ++y) {
        for (std::int64_t x = left; x < right; x += BlockWidth) {
            widest = max(widest, sigma_at(widths, plan, static_cast<std::uint32_t>(y), x));
        }
    }
    const auto radius = static_cast<std::int64_t>(3.0f * largest(widest));
    const std::int64_t first = std::max<std::int64_t>(0, top - radius),
                       last = std::min(height, bottom + radius);
    constexpr auto RowSize = static_cast<std::int64_t>(Features + Layers + 1) * StripPitch;
    if (copy.size() < static_cast<std::size_t>((last - first) * RowSize)) {
        copy.resize(static_cast<std::size_t>((last - first) * RowSize));
    }
    for (std::int64_t y = first; y < last; ++y) {
        const auto near = neighbourhood<Features, Layers>(guide, plan.sources, from,
                                                          static_cast<std::uint32_t>(y), left - StripBorder);
        float* row = copy.data() + (y - first) * RowSize;
        const auto take = [&](const float* plane) { row = std::copy_n(plane, StripPitch, row); };
        std::ranges::for_each(near.sources, take);
        std::ranges::for_each(near.values, take);
        take(near.reduction);
    }
    const Across across{RowSize, -1, 1};
    for (std::int64_t y = top; y < bottom; ++y) {
        const auto line = static_cast<std::uint32_t>(y);
        const float* row = copy.data() + (y - first) * RowSize + StripBorder;
        for (std::int64_t x = left; x < right; x += BlockWidth) {
            Neighbourhood<Features, Layers> near;
            const float* plane = row + (x - left);
            const auto next = [&](const float*& start) {
                start = plane;
                plane += StripPitch;
            };
            std::ranges::for_each(near.sources, next);
            std::ranges::for_each(near.values, next);
            next(near.reduction);
            const Pack sigma = sigma_at(widths, plan, line, x);
            const Steps steps = steps_of(sigma, plan, y, height - 1 - y);
            filter_block(near, target_of<Features>(guide, line, x), sigma, steps, plan, across, line, x, to);
        }
    }
}

template <std::size_t Features, std::size_t Layers>
bool sweep_columns(const Guide& guide, const Widths& widths, const Sweep& plan, const Field& from, Field& to,
                   Strips& strips, RunContext& context) {
    const auto count = [](std::uint32_t size, std::int64_t part) {
        return static_cast<std::uint32_t>((size + part - 1) / part);
    };
    const std::uint32_t down = count(from.values.height(), StripHeight);
    const std::uint32_t strip_count = count(from.values.width(), StripWidth) * down;
    strips.resize(static_cast<std::size_t>(context.arena.max_concurrency()));
    return for_rows(context, strip_count, [&](std::uint32_t i) {
        std::vector<float>& copy =
            strips[static_cast<std::size_t>(tbb::this_task_arena::current_thread_index())];
        sweep_strip<Features, Layers>(guide, widths, plan, from, to, (i / down) * StripWidth,
                                      (i % down) * StripHeight, copy);
    });
}

}  // namespace

bool sweep(const Guide& guide, const Widths& widths, const Sweep& plan, const Field& from, Field& to,
           Strips& strips, RunContext& context) {
    return with_shapes(guide, from, [&](auto features, auto layers) {
        if (plan.direction == Direction::Rows) {
            return sweep_rows<features(), layers()>(guide, widths, plan, from, to, context);
        }
        return sweep_columns<features(), layers()>(guide, widths, plan, from, to, strips, context);
    });
}

bool filter_separable(const Guide& guide, const Widths& widths, int iterations, Edges edges, Field& field,
                      Field& scratch, Strips& strips, RunContext& context) {
    Direction direction = Direction::Rows;
    Sources sources = Sources::Samples;
    for (int k = 1; k <= iterations; ++k) {
        const auto factor = static_cast<float>(iteration_sigma(1.0, k, iterations));
        for (int half = 0; half < 2; ++half) {
            if (!sweep(guide, widths, {direction, factor, 1, sources, edges}, field, scratch, strips,
                       context))
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
