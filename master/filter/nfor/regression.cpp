#include "master/filter/nfor/regression.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tessera::filter::nfor {

namespace {

constexpr float Rounding = 1e-5f;  // r_0
constexpr float Floor = 1e-6f;     // f
constexpr float MaxRidge = 1e4f;
constexpr float Largest = 1e30f;
constexpr float Tiny = 1e-30f;

template <std::size_t I>
Pack variable(const Window& window, const Tap& tap) {
    if constexpr (I == 0) {
        return all(tap.dx);
    } else if constexpr (I == 1) {
        return all(tap.dy);
    } else {
        const float* at = window.features + (I - 2) * window.plane;
        return load(at + tap.offset) - load(at);
    }
}

Pack color(const Window& window, const Tap& tap, std::size_t c) {
    const float* at = window.colors + c * window.plane;
    return load(at + tap.offset) - load(at);
}

struct Sums {
    Pack weight, squared_weight, noise, square;
    std::array<Pack, Colors> color;
    std::array<Pack, Variables> mean;
    std::array<std::array<Pack, Variables>, Variables> product;  // upper half: j >= i
    std::array<std::array<Pack, Colors>, Variables> with_color;
};

void sum_colors(const Window& window, const float* weights, Sums& sums) {
    Pack weight{}, squared{}, noise{}, square{};
    std::array<Pack, Colors> color_sum{};
    for (std::size_t t = 0; t < window.taps.size(); ++t) {
        const Tap& tap = window.taps[t];
        const Pack w = load(weights + t * PackSize);
        weight += w;
        squared += w * w;
        if (!window.correlated) noise += w * load(window.noise + tap.offset);
        for (std::size_t c = 0; c < Colors; ++c) {
            const Pack y = color(window, tap, c);
            color_sum[c] += w * y;
            if (c < 3) square += w * min(y * y, all(Largest));
        }
    }
    sums.weight = weight;
    sums.squared_weight = squared;
    sums.noise = noise;
    sums.square = square;
    sums.color = color_sum;
}

// The weighted variance of the half differences, times the weight.
Pack correlated_noise(const Window& window, const float* weights, Pack weight) {
    Pack noise{};
    for (std::size_t c = 0; c < 3; ++c) {
        const float* at = window.noise + c * window.plane;
        Pack sum{}, squares{};
        for (std::size_t t = 0; t < window.taps.size(); ++t) {
            const Pack w = load(weights + t * PackSize);
            const Pack e = load(at + window.taps[t].offset) - load(at);
            sum += w * e;
            squares += w * min(e * e, all(Largest));
        }
        const Pack mean = sum / max(weight, all(Tiny));
        noise += max(squares - weight * min(mean * mean, all(Largest)), all(0.0f));
    }
    return noise;
}

// Row I of the normal equations: few enough sums to stay in registers.
template <std::size_t I, std::size_t... J>
void sum_row(const Window& window, const float* weights, Sums& sums, std::index_sequence<J...>) {
    Pack mean{};
    std::array<Pack, sizeof...(J)> product{};
    std::array<Pack, Colors> with_color{};
    for (std::size_t t = 0; t < window.taps.size(); ++t) {
        const Tap& tap = window.taps[t];
        const Pack wv = load(weights + t * PackSize) * variable<I>(window, tap);
        mean += wv;
        ((product[J] += wv * variable<I + J>(window, tap)), ...);
        for (std::size_t c = 0; c < Colors; ++c) with_color[c] += wv * color(window, tap, c);
    }
    sums.mean[I] = mean;
    ((sums.product[I][I + J] = product[J]), ...);
    sums.with_color[I] = with_color;
}

template <std::size_t... I>
void sum_rows(const Window& window, const float* weights, Sums& sums, std::index_sequence<I...>) {
    (sum_row<I>(window, weights, sums, std::make_index_sequence<Variables - I>{}), ...);
}

Pack ridge(const Sums& sums, Pack per_weight) {
    const Pack count = sums.weight * sums.weight / max(sums.squared_weight, all(Tiny));
    Pack spread = sums.square * per_weight;
    for (std::size_t c = 0; c < 3; ++c) {
        const Pack mean = sums.color[c] * per_weight;
        spread -= min(mean * mean, all(Largest));
    }
    spread = max(spread, all(0.0f));
    const Pack noise = min(sums.noise * per_weight, all(Largest));
    Pack uncertainty;
    for (std::size_t lane = 0; lane < PackSize; ++lane)
        uncertainty[lane] = std::sqrt(2.0f / std::max(count[lane], 1.0f));
    const Pack signal = max(max(spread - noise, all(0.0f)) + uncertainty * spread, all(Tiny));
    const Pack wanted = noise / (max(count, all(1.0f)) * signal);
    return all(Rounding) + min(wanted, all(MaxRidge));
}

}  // namespace

void Fit::solve(const Window& window, const float* weights) {
    Sums sums;
    sum_colors(window, weights, sums);
    if (window.correlated) sums.noise = correlated_noise(window, weights, sums.weight);
    sum_rows(window, weights, sums, std::make_index_sequence<Variables>{});
    known_ = sums.weight > all(Tiny) ? all(1.0f) : all(0.0f);
    const Pack per_weight = known_ / max(sums.weight, all(Tiny));
    const Pack r = ridge(sums, per_weight);

    std::array<Pack, Variables> mean;
    for (std::size_t i = 0; i < Variables; ++i) mean[i] = sums.mean[i] * per_weight;
    for (std::size_t c = 0; c < Colors; ++c) intercept_[c] = sums.color[c] * per_weight;

    // Factors C + ridge as L D L^T in place; b follows by substitution.
    std::array<std::array<Pack, Variables>, Variables> lower;
    std::array<Pack, Variables> pivot;
    for (std::size_t i = 0; i < Variables; ++i) {
        for (std::size_t j = i; j < Variables; ++j) {
            lower[j][i] = sums.product[i][j] * per_weight - mean[i] * mean[j];
        }
        for (std::size_t c = 0; c < Colors; ++c) {
            slope_[i][c] = sums.with_color[i][c] * per_weight - mean[i] * intercept_[c];
        }
    }
    for (std::size_t i = 0; i < Variables; ++i) {
        const Pack least =
            r * (max(lower[i][i], all(0.0f)) + Floor) + Rounding * (sums.product[i][i] * per_weight);
        Pack d = lower[i][i] + least;
        for (std::size_t k = 0; k < i; ++k) d -= lower[i][k] * lower[i][k] * pivot[k];
        pivot[i] = max(d, least);  // rounding may have made it smaller
        const Pack inverse = 1.0f / pivot[i];
        for (std::size_t j = i + 1; j < Variables; ++j) {
            Pack v = lower[j][i];
            for (std::size_t k = 0; k < i; ++k) v -= lower[j][k] * lower[i][k] * pivot[k];
            lower[j][i] = v * inverse;
        }
        for (std::size_t c = 0; c < Colors; ++c) {
            for (std::size_t k = 0; k < i; ++k) slope_[i][c] -= lower[i][k] * slope_[k][c];
        }
    }
    for (std::size_t i = Variables; i-- > 0;) {
        for (std::size_t c = 0; c < Colors; ++c) {
            slope_[i][c] /= pivot[i];
            for (std::size_t k = i + 1; k < Variables; ++k) slope_[i][c] -= lower[k][i] * slope_[k][c];
        }
    }
    for (std::size_t i = 0; i < Variables; ++i) {
        for (std::size_t c = 0; c < Colors; ++c) intercept_[c] -= slope_[i][c] * mean[i];
    }
}

namespace {

template <std::size_t... I>
std::array<Pack, Variables> variables(const Window& window, const Tap& tap, std::index_sequence<I...>) {
    return {variable<I>(window, tap)...};
}

}  // namespace

std::array<Pack, Colors> Fit::at(const Window& window, const Tap& tap) const {
    const std::array<Pack, Variables> v = variables(window, tap, std::make_index_sequence<Variables>{});
    std::array<Pack, Colors> colors = intercept_;
    for (std::size_t i = 0; i < Variables; ++i) {
        for (std::size_t c = 0; c < Colors; ++c) colors[c] += slope_[i][c] * v[i];
    }
    return colors;
}

}  // namespace tessera::filter::nfor
