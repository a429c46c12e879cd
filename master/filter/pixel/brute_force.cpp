#include <utility>

#include "master/filter/pixel/gather.h"
#include "master/filter/pixel/plane_filters.h"

namespace tessera::filter::pixel {

bool filter_brute_force(const Guide& guide, const Widths& widths, Field& field, Field& scratch,
                        RunContext& context) {
    const auto width = static_cast<std::int64_t>(field.values.width());
    const auto height = static_cast<std::int64_t>(field.values.height());
    const bool done = with_shapes(guide, field, [&](auto features, auto layers) {
        return for_rows(context, static_cast<std::uint32_t>(height), [&](std::uint32_t y) {
            for (std::int64_t x = 0; x < width; x += BlockWidth) {
                const auto target = target_of<features()>(guide, y, x);
                const Pack sigma = max(load(widths.row(0, y) + x), all(1e-3f));
                const Pack spread = 0.5f * 1.44269504f / (sigma * sigma);
                const auto radius = static_cast<std::int64_t>(3.0f * largest(sigma));
                const std::int64_t first = -std::min(radius, x + BlockWidth - 1);
                const std::int64_t last = std::min(radius, width - 1 - x);
                Sums<layers()> sums;
                for (std::int64_t d = -std::min<std::int64_t>(radius, y);
                     d <= std::min(radius, height - 1 - std::int64_t{y}); ++d) {
                    const auto row = static_cast<std::uint32_t>(y + d);
                    const auto near =
                        neighbourhood<features(), layers()>(guide, Sources::Samples, field, row, x);
                    gather(near, target, spread, static_cast<float>(d * d), first, last, 1, 1, sums);
                }
                const auto here = neighbourhood<features(), layers()>(guide, Sources::Samples, field, y, x);
                keep_or_store(sums, here, normalised(sums), y, x, scratch);
            }
        });
    });
    std::swap(field, scratch);
    return done;
}

}  // namespace tessera::filter::pixel
