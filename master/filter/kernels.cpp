#include "master/filter/kernels.h"

#include <algorithm>

namespace tessera::filter {

void box_mean(const Planes& in, std::uint32_t radius, Planes& scratch, Planes& out, RunContext& context) {
    const std::uint32_t width = in.width(), height = in.height();
    const auto fit = [&](Planes& planes) {
        if (planes.width() != width || planes.height() != height || planes.components() != in.components()) {
            planes = Planes(width, height, in.components());
        }
    };
    fit(scratch);
    fit(out);
    const auto r = static_cast<std::int64_t>(radius);
    for (std::uint32_t c = 0; c < in.components(); ++c) {
        for_rows(context, height, [&](std::uint32_t y) {
            const float* from = in.row(c, y);
            float* to = scratch.row(c, y);
            const auto w = static_cast<std::int64_t>(width);
            double sum = 0.0;
            for (std::int64_t x = 0; x < std::min(r, w); ++x) sum += from[x];
            for (std::int64_t x = 0; x < w; ++x) {
                if (x + r < w) sum += from[x + r];
                if (x - r - 1 >= 0) sum -= from[x - r - 1];
                const std::int64_t count = std::min(x + r, w - 1) - std::max<std::int64_t>(x - r, 0) + 1;
                to[x] = static_cast<float>(sum / static_cast<double>(count));
            }
        });
        // Down the columns, in stripes so that a cache line is used whole.
        constexpr std::uint32_t Stripe = 64;
        for_rows(context, (width + Stripe - 1) / Stripe, [&](std::uint32_t stripe) {
            const std::uint32_t first = stripe * Stripe, last = std::min(width, first + Stripe);
            const auto h = static_cast<std::int64_t>(height);
            double sums[Stripe] = {};
            const auto add = [&](std::int64_t y, double sign) {
                const float* from = scratch.row(c, static_cast<std::uint32_t>(y));
                for (std::uint32_t x = first; x < last; ++x) sums[x - first] += sign * from[x];
            };
            for (std::int64_t y = 0; y < std::min(r, h); ++y) add(y, 1.0);
            for (std::int64_t y = 0; y < h; ++y) {
                if (y + r < h) add(y + r, 1.0);
                if (y - r - 1 >= 0) add(y - r - 1, -1.0);
                const std::int64_t count = std::min(y + r, h - 1) - std::max<std::int64_t>(y - r, 0) + 1;
                float* to = out.row(c, static_cast<std::uint32_t>(y));
                for (std::uint32_t x = first; x < last; ++x) {
                    to[x] = static_cast<float>(sums[x - first] / static_cast<double>(count));
                }
            }
        });
    }
}

}  // namespace tessera::filter
