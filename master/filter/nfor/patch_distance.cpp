#include "master/filter/nfor/patch_distance.h"

#include <algorithm>

namespace tessera::filter::nfor {

namespace {

constexpr float Largest = 1e30f;  // of squares and variances, so that their sums are finite
constexpr float Tiny = 1e-30f;
constexpr float Cut = 1e6f;
constexpr std::size_t PairColumns = (Tiles::Width + 2 * MaxPatch + PackSize - 1) / PackSize * PackSize;

}  // namespace

void PatchDistance::reserve(const PatchSettings& settings, std::uint32_t components) {
    settings_ = settings;
    halo_ = settings.radius + settings.patch;
    columns_ = (Tiles::Width + 2 * halo_ + PackSize - 1) / PackSize * PackSize + PackSize;
    plane_ = columns_ * (Tiles::Height + 2 * halo_) + PackSize;
    window_.resize(plane_ * (1 + 2 * components));
    pairs_.resize(PairColumns * (Tiles::Height + 2 * settings.patch));
    column_sums_.resize(PairColumns + PackSize);
    noise_.resize(pairs_.size());
    noise_sums_.resize(column_sums_.size());
}

void PatchDistance::load(const Guide& guide, const Tile& tile) {
    components_ = guide.values.components();
    correlated_ = guide.correlated;
    height_ = tile.height;
    const std::size_t rows = Tiles::Height + 2 * halo_;
    const std::uint32_t width = guide.values.width(), height = guide.values.height();
    const auto copy = [&](std::uint32_t plane, const auto& value) {
        copy_window(width, height, std::int64_t{tile.x} - halo_, std::int64_t{tile.y} - halo_,
                    static_cast<std::uint32_t>(columns_), static_cast<std::uint32_t>(rows),
                    window_.data() + plane * plane_, columns_, 0.0f,
                    [&](std::uint32_t y, std::uint32_t first, std::uint32_t last, float* to) {
                        for (std::uint32_t x = first; x < last; ++x) to[x - first] = value(y, x);
                    });
    };
    copy(0, [&](std::uint32_t y, std::uint32_t x) { return guide.known.row(0, y)[x] > 0.0f ? 1.0f : 0.0f; });
    for (std::uint32_t c = 0; c < components_; ++c) {
        copy(1 + 2 * c, [&](std::uint32_t y, std::uint32_t x) { return guide.values.row(c, y)[x]; });
        copy(2 + 2 * c, [&](std::uint32_t y, std::uint32_t x) {
            return std::clamp(guide.variances.row(c, y)[x], -Largest, Largest);
        });
    }
}

template <std::uint32_t Components>
void PatchDistance::pairs(std::int32_t dx, std::int32_t dy) {
    const std::size_t rows = height_ + 2 * settings_.patch;
    for (std::size_t row = 0; row < rows; ++row) {
        const float* a = window_.data() + (settings_.radius + row) * columns_ + settings_.radius;
        const float* b = a + dy * static_cast<std::ptrdiff_t>(columns_) + dx;
        float* to = pairs_.data() + row * PairColumns;
        for (std::size_t x = 0; x < PairColumns; x += PackSize) {
            Pack sum = all(0.0f);
            for (std::uint32_t c = 0; c < Components; ++c) {
                const std::size_t value = (1 + 2 * c) * plane_ + x, variance = (2 + 2 * c) * plane_ + x;
                const Pack d = filter::load(a + value) - filter::load(b + value);
                const Pack va = filter::load(a + variance), vb = filter::load(b + variance);
                const Pack excess = min(d * d, all(Largest)) - (va + min(va, vb));
                sum += min(excess / (va + vb + Tiny), all(Cut));
            }
            store(to + x, sum * (filter::load(a + x) * filter::load(b + x)));
        }
    }
}

void PatchDistance::correlated_pairs(std::int32_t dx, std::int32_t dy) {
    const std::size_t rows = height_ + 2 * settings_.patch;
    for (std::size_t row = 0; row < rows; ++row) {
        const float* a = window_.data() + (settings_.radius + row) * columns_ + settings_.radius;
        const float* b = a + dy * static_cast<std::ptrdiff_t>(columns_) + dx;
        for (std::size_t x = 0; x < PairColumns; x += PackSize) {
            Pack sum = all(0.0f), noise = all(0.0f);
            for (std::uint32_t c = 0; c < components_; ++c) {
                const std::size_t value = (1 + 2 * c) * plane_ + x, half = (2 + 2 * c) * plane_ + x;
                const Pack d = filter::load(a + value) - filter::load(b + value);
                const Pack e = filter::load(a + half) - filter::load(b + half);
                sum += min(d * d, all(Largest));
                noise += min(e * e, all(Largest));
            }
            const Pack known = filter::load(a + x) * filter::load(b + x);
            store(pairs_.data() + row * PairColumns + x, sum * known);
            store(noise_.data() + row * PairColumns + x, noise * known);
        }
    }
}

void PatchDistance::compute_correlated(std::uint32_t step, float* to) {
    const std::uint32_t side = 2 * settings_.patch + 1;
    for (std::uint32_t y = 0; y < height_; y += step, to += Tiles::Width) {
        for (std::size_t x = 0; x < PairColumns; x += PackSize) {
            Pack sum = all(0.0f), noise = all(0.0f);
            for (std::uint32_t i = 0; i < side; ++i) {
                sum += filter::load(pairs_.data() + (y + i) * PairColumns + x);
                noise += filter::load(noise_.data() + (y + i) * PairColumns + x);
            }
            store(column_sums_.data() + x, sum);
            store(noise_sums_.data() + x, noise);
        }
        for (std::size_t x = 0; x < Tiles::Width; x += PackSize) {
            Pack sum = all(0.0f), noise = all(0.0f);
            for (std::uint32_t i = 0; i < side; ++i) {
                sum += filter::load(column_sums_.data() + x + i);
                noise += filter::load(noise_sums_.data() + x + i);
            }
            store(to + x, min(max((sum - noise) / (noise + Tiny), all(0.0f)), all(Cut)));
        }
    }
}

void PatchDistance::compute(std::int32_t dx, std::int32_t dy, std::uint32_t step, float* to) {
    if (correlated_) {
        correlated_pairs(dx, dy);
        return compute_correlated(step, to);
    }
    components_ == 1 ? pairs<1>(dx, dy) : pairs<3>(dx, dy);
    const std::uint32_t side = 2 * settings_.patch + 1;
    const Pack scale = all(1.0f / static_cast<float>(components_ * side * side));
    for (std::uint32_t y = 0; y < height_; y += step, to += Tiles::Width) {
        for (std::size_t x = 0; x < PairColumns; x += PackSize) {
            const float* from = pairs_.data() + y * PairColumns + x;
            Pack sum = filter::load(from);
            for (std::uint32_t i = 1; i < side; ++i) sum += filter::load(from + i * PairColumns);
            store(column_sums_.data() + x, sum);
        }
        for (std::size_t x = 0; x < Tiles::Width; x += PackSize) {
            const float* from = column_sums_.data() + x;
            Pack sum = filter::load(from);
            for (std::uint32_t i = 1; i < side; ++i) sum += filter::load(from + i);
            store(to + x, max(sum * scale, all(0.0f)));
        }
    }
}

}  // namespace tessera::filter::nfor
