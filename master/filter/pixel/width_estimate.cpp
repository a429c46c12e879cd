#include "master/filter/pixel/width_estimate.h"

#include <algorithm>

#include "master/filter/pixel/blend_factor.h"
#include "master/filter/pixel/widths.h"

namespace tessera::filter::pixel {

bool WidthEstimate::run(const Guide& guide, const Light& light, const Inputs& inputs, const Field& field,
                        const AdaptiveWidths& rule, Widths& widths, Strips& strips, RunContext& context) {
    const std::uint32_t width = inputs.width, height = inputs.height;
    const bool weighted = field.weighted;
    field_.fit(width, height, weighted ? 3 : 2, weighted);
    scratch_.fit(width, height, weighted ? 3 : 2, weighted);
    widths.fit(width, height, 1);
    for_rows(context, height, [&](std::uint32_t y) {
        const float *r = field.values.row(0, y), *g = field.values.row(1, y), *b = field.values.row(2, y);
        float* to = field_.values.row(0, y);
        for (std::uint32_t x = 0; x < width; ++x) to[x] = luminance(r[x], g[x], b[x]);
        std::copy_n(field.values.row(Field::Variance, y), width, field_.values.row(1, y));
        if (weighted) std::copy_n(field.weight_row(y), width, field_.values.row(2, y));
        std::fill_n(widths.row(0, y), width, rule.base);
    });
    const Sweep rows{.direction = Direction::Rows, .spacing = 2, .sources = Sources::Samples};
    const Sweep columns{.direction = Direction::Columns, .spacing = 2};
    if (!sweep(guide, widths, rows, field_, scratch_, strips, context)) return false;
    if (!sweep(guide, widths, columns, scratch_, field_, strips, context)) return false;
    return for_rows(context, height, [&](std::uint32_t y) {
        float* sigma = widths.row(0, y);
        const float *r = light.low().row(0, y), *g = light.low().row(1, y), *b = light.low().row(2, y);
        float *high = field_.values.row(0, y), *variance = field_.values.row(1, y);
        const float* n = inputs.counts.row(0, y);
        if (weighted) {
            const float* weight = field_.weight_row(y);
            for (std::uint32_t x = 0; x < width; ++x) {
                high[x] /= weight[x];
                variance[x] /= weight[x] * std::max(n[x], 1.0f);
            }
        }
        for (std::uint32_t x = 0; x < width; ++x) {
            const float background = high[x] + luminance(r[x], g[x], b[x]);
            const float u = perceived_variance(variance[x], background);
            sigma[x] = adaptive_sigma(u, rule.threshold, n[x], rule.base, rule.clamp);
        }
    });
}

}  // namespace tessera::filter::pixel
