#include "master/filter/lost_light.h"

#include <algorithm>
#include <limits>

#include "master/filter/kernels.h"

namespace tessera::filter {

void LostLight::Loss::add(const Loss& other) {
    for (std::size_t c = 0; c < 4; ++c) {
        light[c] += other.light[c];
        square[c] += other.square[c];
    }
    for (std::size_t c = 0; c < 3; ++c) variance[c] += other.variance[c];
    noise += other.noise;
}

// What a pixel gets of each component for its noise.
std::array<float, 4> LostLight::Loss::per_noise() const {
    std::array<float, 4> gain{};
    if (!(noise > 0.0)) return gain;
    double mean_part = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double total = light[c] * light[c], uncertain = std::min(variance[c], square[c]);
        if (total <= uncertain) continue;
        const double part = 1.0 - uncertain / total;
        mean_part += part / 3.0;
        gain[c] = static_cast<float>(part * light[c] / noise);
    }
    gain[3] = static_cast<float>(mean_part * light[3] / noise);
    return gain;
}

// Adds row `y` of the picture to `loss`, but its lost light to `tiles`.
void LostLight::add_row(const Inputs& inputs, frame::Channel filtered_part, std::span<const float> noise,
                        const Planes& picture, std::uint32_t y, Loss& loss, double* tiles) {
    const std::uint32_t width = inputs.width, components = picture.components();
    const float *counts = inputs.counts.row(0, y), *own_noise = noise.data() + std::size_t{y} * width;
    const float* alpha = components > 3 ? picture.row(3, y) : nullptr;
    for (std::uint32_t c = 0; c < components; ++c) {
        const float *u = inputs.color(c).data() + std::size_t{y} * width, *out = picture.row(c, y);
        for (std::uint32_t begin = 0; begin < width; begin += TileSize) {
            double& sum = tiles[begin / TileSize * 4 + c];
            for (std::uint32_t x = begin; x < std::min(begin + TileSize, width); ++x)
                sum += counts[x] >= 2.0f ? double(u[x]) - double(out[x]) : 0.0;
        }
    }
    for (std::uint32_t c = 0; c < 3; ++c) {
        const float* v = inputs.variance(filtered_part).row(c, y);
        double sum = 0.0;
        for (std::uint32_t x = 0; x < width; ++x) sum += counts[x] >= 2.0f ? double(v[x]) : 0.0;
        loss.variance[c] += sum;
    }
    double sum = 0.0;
    for (std::uint32_t x = 0; x < width; ++x)
        sum += counts[x] >= 2.0f ? double(own_noise[x] * (alpha == nullptr ? 1.0f : alpha[x])) : 0.0;
    loss.noise += sum;
}

bool LostLight::restore(const Inputs& inputs, frame::Channel filtered_part, std::span<const float> noise,
                        Planes& picture, RunContext& context) {
    const std::uint32_t width = inputs.width, components = picture.components();
    const std::uint32_t columns = (width + TileSize - 1) / TileSize;
    const std::uint32_t rows = (inputs.height + TileSize - 1) / TileSize;
    losses_.assign(rows, {});
    tiles_.assign(std::size_t{rows} * columns * 4, 0.0);
    const bool done = for_rows(context, rows, [&](std::uint32_t row) {
        Loss loss;
        double* tiles = tiles_.data() + std::size_t{row} * columns * 4;
        const std::uint32_t end = std::min(inputs.height, (row + 1) * TileSize);
        for (std::uint32_t y = row * TileSize; y < end; ++y)
            add_row(inputs, filtered_part, noise, picture, y, loss, tiles);
        for (std::size_t i = 0; i < columns * std::size_t{4}; ++i) {
            loss.light[i % 4] += tiles[i];
            loss.square[i % 4] += tiles[i] * tiles[i];
        }
        losses_[row] = loss;
    });
    if (!done) return false;
    Loss all;
    for (const Loss& row : losses_) all.add(row);
    const std::array<float, 4> gain = all.per_noise();
    if (gain == std::array<float, 4>{}) return true;
    return for_rows(context, inputs.height, [&](std::uint32_t y) {
        const float *counts = inputs.counts.row(0, y), *own_noise = noise.data() + std::size_t{y} * width;
        const float* alpha = components > 3 ? picture.row(3, y) : nullptr;
        for (std::uint32_t c = 0; c < components; ++c) {  // alpha last, on which the shares depend
            float* out = picture.row(c, y);
            const float most = c == 3 ? 1.0f : std::numeric_limits<float>::max();
            for (std::uint32_t x = 0; x < width; ++x) {
                const float share = own_noise[x] * (alpha == nullptr ? 1.0f : alpha[x]);
                const float more = std::clamp(out[x] + gain[c] * share, 0.0f, most);
                out[x] = counts[x] >= 2.0f ? more : out[x];
            }
        }
    });
}

}  // namespace tessera::filter
