#include "master/filter/fdf/nl_means.h"

#include <algorithm>
#include <cmath>

#include "master/filter/kernels.h"
#include "master/filter/tiles.h"

namespace tessera::filter {

namespace {

constexpr float Log2E = 1.44269504f;
constexpr float Outside = -1.0f;  // no PixelClass

std::uint32_t up_to_packs(std::uint32_t n) {
    return (n + PackSize - 1) / PackSize * PackSize;
}

// Layout of a thread's scratch memory. Reads may go one pack beyond a row.
struct Layout {
    Layout(const Tile& tile, const NlmSettings& settings)
        : halo(settings.radius + settings.patch),
          columns(up_to_packs(tile.width + 2 * halo) + PackSize),
          rows(tile.height + 2 * halo),
          pair_columns(up_to_packs(tile.width + 2 * settings.patch)),
          pair_rows(tile.height + 2 * settings.patch),
          sum_columns(up_to_packs(tile.width)) {}
    std::uint32_t halo, columns, rows;
    std::uint32_t pair_columns, pair_rows;  // pixels whose pairs the patches of the tile need
    std::uint32_t sum_columns;

    std::size_t window_size() const { return std::size_t{columns} * rows + PackSize; }
    std::size_t total() const {
        return 4 * window_size() + pair_columns + PackSize + std::size_t{sum_columns} * pair_rows +
               3 * std::size_t{sum_columns} * (rows - 2 * halo);
    }
};

template <NlmForm Form>
Pack pair_distance(Pack va, Pack vb, Pack ca, Pack cb, Pack variance_a, Pack variance_b, float k2) {
    const Pack d = va - vb, both = variance_a + variance_b;
    if constexpr (Form == NlmForm::Thesis) {
        constexpr float Equal = 0.57735027f;
        const Pack e = exp2_negative(d * d * Log2E / (NlmEpsilon + both));
        return where_equal(ca, cb, e - Equal) + Equal;
    } else {
        const Pack e = (d * d - (variance_a + min(variance_a, variance_b))) / (NlmEpsilon + k2 * both);
        return where_equal(ca, cb, e);
    }
}

// The tile without its halo.
void copy_centre(const Tile& tile, const Layout& layout, const float* window, float* to) {
    const float* from = window + std::size_t{layout.halo} * layout.columns + layout.halo;
    for (std::uint32_t y = 0; y < tile.height; ++y, from += layout.columns, to += layout.sum_columns)
        std::copy_n(from, layout.sum_columns, to);
}

void divide_tile(const Tile& tile, const Layout& layout, const float* sums, const float* weights,
                 Planes& out) {
    for (std::uint32_t y = 0; y < tile.height; ++y) {
        float* to = out.row(0, tile.y + y) + tile.x;
        const std::size_t from = std::size_t{y} * layout.sum_columns;
        for (std::uint32_t x = 0; x < tile.width; ++x) to[x] = sums[from + x] / weights[from + x];
    }
}

template <NlmForm Form, std::uint32_t Patch>
void run_tile(const Tile& tile, const Layout& layout, const NlmSettings& settings, float* scratch,
              Planes& out, Planes* out_change) {
    constexpr std::uint32_t Side = 2 * Patch + 1;
    const float* values = scratch;
    const float* variances = values + layout.window_size();
    const float* classes = variances + layout.window_size();
    const float* changes = classes + layout.window_size();
    float* pairs = scratch + 4 * layout.window_size();
    float* row_cdf = pairs + layout.pair_columns + PackSize;
    float* sums = row_cdf + std::size_t{layout.sum_columns} * layout.pair_rows;
    float* weights = sums + std::size_t{layout.sum_columns} * tile.height;
    float* changed = weights + std::size_t{layout.sum_columns} * tile.height;
    const float k2 = settings.k * settings.k;
    const std::size_t columns = layout.columns;
    const std::size_t centre = layout.halo * columns + layout.halo;

    copy_centre(tile, layout, values, sums);
    if (out_change) copy_centre(tile, layout, changes, changed);
    std::fill_n(weights, std::size_t{layout.sum_columns} * tile.height, 1.0f);
    const auto radius = static_cast<std::int64_t>(settings.radius);
    for (std::int64_t oy = -radius; oy <= radius; ++oy) {
        for (std::int64_t ox = -radius; ox <= radius; ++ox) {
            if (ox == 0 && oy == 0) continue;
            const std::int64_t offset = oy * static_cast<std::int64_t>(columns) + ox;
            for (std::uint32_t y = 0; y < layout.pair_rows; ++y) {
                const std::size_t row = (settings.radius + y) * columns + settings.radius;
                for (std::uint32_t x = 0; x < layout.pair_columns; x += PackSize) {
                    const float* a = values + row + x;
                    const float* variance = variances + row + x;
                    const float* kind = classes + row + x;
                    store(pairs + x,
                          pair_distance<Form>(load(a), load(a + offset), load(kind), load(kind + offset),
                                              load(variance), load(variance + offset), k2));
                }
                float* to = row_cdf + std::size_t{y} * layout.sum_columns;
                for (std::uint32_t x = 0; x < layout.sum_columns; x += PackSize) {
                    Pack sum = load(pairs + x);
                    for (std::uint32_t i = 1; i < Side; ++i) sum += load(pairs + x + i);
                    store(to + x, sum);
                }
            }
            for (std::uint32_t y = 0; y < tile.height; ++y) {
                const std::size_t row = centre + y * columns;
                const float* from = row_cdf + std::size_t{y} * layout.sum_columns;
                float* sum = sums + std::size_t{y} * layout.sum_columns;
                float* weight = weights + std::size_t{y} * layout.sum_columns;
                float* change = changed + std::size_t{y} * layout.sum_columns;
                for (std::uint32_t x = 0; x < layout.sum_columns; x += PackSize) {
                    Pack d = load(from + x);
                    for (std::uint32_t i = 1; i < Side; ++i) d += load(from + i * layout.sum_columns + x);
                    Pack w;
                    if constexpr (Form == NlmForm::Thesis) {
                        w = d * (1.0f / (Side * Side));
                    } else {
                        w = exp2_negative(max(d, all(0.0f)) * (Log2E / (Side * Side)));
                    }
                    const float* kind = classes + row + x;
                    w = where_equal(load(kind), load(kind + offset), w);
                    store(sum + x, load(sum + x) + w * load(values + row + x + offset));
                    store(weight + x, load(weight + x) + w);
                    if (out_change)
                        store(change + x, load(change + x) + w * load(changes + row + x + offset));
                }
            }
        }
    }
    divide_tile(tile, layout, sums, weights, out);
    if (out_change) divide_tile(tile, layout, changed, weights, *out_change);
}

using TileFunction = void (*)(const Tile&, const Layout&, const NlmSettings&, float*, Planes&, Planes*);

template <NlmForm Form>
TileFunction function_for(std::uint32_t patch) {
    switch (patch) {
        case 0:
            return run_tile<Form, 0>;
        case 1:
            return run_tile<Form, 1>;
        case 2:
            return run_tile<Form, 2>;
        case 3:
            return run_tile<Form, 3>;
        default:
            return run_tile<Form, NlmMaxPatch>;
    }
}

}  // namespace

bool NlMeans::run(const Planes& values, const Planes& variances, const Planes& classes,
                  const NlmSettings& settings, Planes& out, RunContext& context, const Planes* change,
                  Planes* out_change) {
    const TileFunction function = settings.form == NlmForm::Thesis
                                      ? function_for<NlmForm::Thesis>(settings.patch)
                                      : function_for<NlmForm::Standard>(settings.patch);
    const Tiles tiles(values.width(), values.height());
    scratch_.reserve(context, Layout({0, 0, Tiles::Width, Tiles::Height}, settings).total());
    return for_rows(context, tiles.count(), [&](std::uint32_t index) {
        const Tile tile = tiles.tile(index);
        const Layout layout(tile, settings);
        float* const scratch = scratch_.local();
        float* to = scratch;
        for (const Planes* plane : {&values, &variances, &classes, change}) {
            if (!plane) continue;
            copy_window(plane->width(), plane->height(), std::int64_t{tile.x} - layout.halo,
                        std::int64_t{tile.y} - layout.halo, layout.columns, layout.rows, to, layout.columns,
                        plane == &classes ? Outside : 0.0f,
                        [&](std::uint32_t y, std::uint32_t first, std::uint32_t last, float* row) {
                            std::copy(plane->row(0, y) + first, plane->row(0, y) + last, row);
                        });
            std::fill_n(to + std::size_t{layout.columns} * layout.rows, PackSize, 0.0f);
            to += layout.window_size();
        }
        function(tile, layout, settings, scratch, out, change ? out_change : nullptr);
    });
}

}  // namespace tessera::filter
