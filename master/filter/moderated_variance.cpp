#include "master/filter/moderated_variance.h"

#include <algorithm>
#include <array>

namespace tessera::filter {

namespace {

constexpr std::int64_t Chunk = 256;
constexpr std::int64_t MostRadius = 8;
constexpr std::int64_t Wide = Chunk + 2 * MostRadius;
constexpr float Largest = 1e30f;  // keeps sums of squares of a window finite

// The quantities summed over the square: degrees of freedom, known pixels, and per channel the weighted
// variance of one sample, the mean and its square.
enum Quantity : std::size_t {
    Dof,
    Known,
    Weighted,
    Mean = Weighted + 3,
    Square = Mean + 3,
    Quantities = Square + 3
};
using Sums = std::array<std::array<float, Wide>, Quantities>;

struct Row {
    const float* counts;
    std::array<const float*, 3> means, variances;
};

Row row_of(const Inputs& inputs, frame::Channel channel, std::uint32_t y) {
    const Planes& mean = inputs.mean(channel);
    const Planes& variance = inputs.variance(channel);
    return {inputs.counts.row(0, y),
            {mean.row(0, y), mean.row(1, y), mean.row(2, y)},
            {variance.row(0, y), variance.row(1, y), variance.row(2, y)}};
}

// Adds the columns [first, last) of a row to the sums, from index `at` on.
void add_row(Sums& sums, const Row& row, std::int64_t first, std::int64_t last, std::int64_t at) {
    for (std::int64_t x = first; x < last; ++x) {
        const float n = row.counts[x];
        sums[Dof][at + x - first] += std::max(n - 1.0f, 0.0f);
        sums[Known][at + x - first] += n > 0.0f ? 1.0f : 0.0f;
    }
    for (std::size_t c = 0; c < 3; ++c) {
        const float* m = row.means[c];
        const float* v = row.variances[c];
        for (std::int64_t x = first; x < last; ++x) {
            const float n = row.counts[x];
            sums[Weighted + c][at + x - first] += std::min(std::max(n - 1.0f, 0.0f) * n * v[x], Largest);
            sums[Mean + c][at + x - first] += m[x];
            sums[Square + c][at + x - first] += std::min(m[x] * m[x], Largest);
        }
    }
}

float along(const std::array<float, Wide>& columns, std::int64_t at, std::int64_t radius) {
    float sum = 0.0f;
    for (std::int64_t d = -radius; d <= radius; ++d) sum += columns[static_cast<std::size_t>(at + d)];
    return sum;
}

}  // namespace

bool ModeratedVariance::run(const Inputs& inputs, float k, std::uint32_t radius, RunContext& context,
                            frame::Channel channel) {
    shape(variance_, inputs, 3);
    shape(dof_, inputs, 1);
    const std::int64_t width = inputs.width, height = inputs.height;
    const std::int64_t r = std::min<std::int64_t>(radius, MostRadius);
    return for_rows(context, inputs.height, [&](std::uint32_t y) {
        const Row own = row_of(inputs, channel, y);
        float* dof = dof_.row(0, y);
        for (std::int64_t begin = 0; begin < width; begin += Chunk) {
            const std::int64_t end = std::min(begin + Chunk, width);
            Sums columns{};  // of columns begin - r ...; outside of the picture 0
            const std::int64_t first = std::max<std::int64_t>(begin - r, 0), last = std::min(end + r, width);
            for (std::int64_t row = std::max<std::int64_t>(y - r, 0); row < std::min(y + r + 1, height);
                 ++row) {
                add_row(columns, row_of(inputs, channel, static_cast<std::uint32_t>(row)), first, last,
                        first - (begin - r));
            }
            std::array<std::array<float, Chunk>, Quantities> square;
            for (std::size_t i = 0; i < Quantities; ++i) {
                for (std::int64_t x = 0; x < end - begin; ++x) square[i][x] = along(columns[i], x + r, r);
            }
            for (std::int64_t x = begin; x < end; ++x) {
                const float n = own.counts[x], pooled = n > 0.0f ? k : 0.0f;
                dof[x] = n == 1.0f ? std::max(pooled, 1.0f) : std::max(n - 1.0f, 0.0f) + pooled;
            }
            for (std::size_t c = 0; c < 3; ++c) {
                float* to = variance_.row(static_cast<std::uint32_t>(c), y);
                for (std::int64_t x = begin; x < end; ++x) {
                    const std::size_t at = static_cast<std::size_t>(x - begin);
                    const float n = own.counts[x], known = std::max(square[Known][at], 1.0f);
                    const float mean = square[Mean + c][at] / known;
                    const float spatial = std::max(square[Square + c][at] / known - mean * mean, 0.0f);
                    const float freedom = square[Dof][at];
                    const float prior = freedom > 0.0f ? square[Weighted + c][at] / (freedom * n) : spatial;
                    const float own_dof = std::max(n - 1.0f, 0.0f);
                    const float moderated =
                        (own_dof * own.variances[c][x] + k * prior) / std::max(own_dof + k, 1e-6f);
                    to[x] = n > 1.0f ? moderated : n > 0.0f ? prior : 0.0f;
                }
            }
        }
    });
}

}  // namespace tessera::filter
