#pragma once

#include <array>
#include <type_traits>

#include "master/filter/pack.h"
#include "master/filter/pixel/field.h"

// The inner loop of every method: weighted sums over the neighbours of eight pixels (Schwenk 3.6).
namespace tessera::filter::pixel {

inline constexpr std::int64_t BlockWidth = PackSize;  // pixels of a row that are filtered at once

// Below this sum of weights a pixel has no similar neighbours. Only holes can: others have weight 1
// themselves.
inline constexpr float LeastWeight = 1e-6f;

// Rows of the planes at the eight pixels; the offset to a neighbour is the same in all of them.
template <std::size_t Features, std::size_t Layers>
struct Neighbourhood {
    std::array<const float*, Features> sources;
    std::array<const float*, Layers> values;
    const float* reduction;
};

// Unnormalised: weights, values times weights, and r times squared weights.
template <std::size_t Layers>
struct Sums {
    Pack weight{}, reduction{};
    std::array<Pack, Layers> values{};
};

// Adds the neighbour `at` floats away; `cost` is -log2 of its spatial weight.
template <std::size_t Features, std::size_t Layers>
inline void add(const Neighbourhood<Features, Layers>& from, const std::array<Pack, Features>& target,
                Pack cost, std::ptrdiff_t at, Sums<Layers>& sums) {
    for (std::size_t k = 0; k < Features; ++k) {
        const Pack difference = load(from.sources[k] + at) - target[k];
        cost += difference * difference;
    }
    const Pack weight = exp2_negative(cost);
    sums.weight += weight;
    for (std::size_t k = 0; k < Layers; ++k) sums.values[k] += weight * load(from.values[k] + at);
    sums.reduction += weight * weight * load(from.reduction + at);
}

// Adds the neighbours at first, first + spacing, ..., last steps of `stride` floats. `spread` = log2(e) /
// (2 sigma^2) of the spatial weight, of which `across` is the squared distance in the other dimension.
template <std::size_t Features, std::size_t Layers>
inline void gather(const Neighbourhood<Features, Layers>& from, const std::array<Pack, Features>& target,
                   Pack spread, float across, std::int64_t first, std::int64_t last, std::int64_t spacing,
                   std::ptrdiff_t stride, Sums<Layers>& sums) {
    std::ptrdiff_t at = first * stride;
    auto d = static_cast<float>(first);
    for (std::int64_t i = first; i <= last; i += spacing) {
        add(from, target, spread * (d * d + across), at, sums);
        at += spacing * stride;
        d += static_cast<float>(spacing);
    }
}

template <std::size_t Layers>
struct Result {
    std::array<Pack, Layers> values;
    Pack reduction;
};

template <std::size_t Layers>
inline Result<Layers> normalised(const Sums<Layers>& sums) {
    Result<Layers> result;
    const Pack inverse = 1.0f / max(sums.weight, all(LeastWeight));
    for (std::size_t k = 0; k < Layers; ++k) result.values[k] = sums.values[k] * inverse;
    result.reduction = sums.reduction * inverse * inverse;
    return result;
}

template <std::size_t Features, std::size_t Layers>
inline Neighbourhood<Features, Layers> neighbourhood(const Guide& guide, Sources sources, const Field& from,
                                                     std::uint32_t y, std::int64_t x) {
    Neighbourhood<Features, Layers> near;
    for (std::uint32_t k = 0; k < Features; ++k) near.sources[k] = guide.source_row(k, y, sources) + x;
    for (std::uint32_t k = 0; k < Layers; ++k) near.values[k] = from.values.row(k, y) + x;
    near.reduction = from.reduction.row(0, y) + x;
    return near;
}

template <std::size_t Features>
inline std::array<Pack, Features> target_of(const Guide& guide, std::uint32_t y, std::int64_t x) {
    std::array<Pack, Features> target;
    for (std::uint32_t k = 0; k < Features; ++k) target[k] = load(guide.target_row(k, y) + x);
    return target;
}

// Keeps the values of pixels without similar neighbours.
template <std::size_t Features, std::size_t Layers>
inline void keep_or_store(const Sums<Layers>& sums, const Neighbourhood<Features, Layers>& near,
                          const Result<Layers>& result, std::uint32_t y, std::int64_t x, Field& to) {
    const auto keep = sums.weight < LeastWeight;
    for (std::uint32_t k = 0; k < Layers; ++k) {
        store(to.values.row(k, y) + x, keep ? load(near.values[k]) : result.values[k]);
    }
    store(to.reduction.row(0, y) + x, keep ? load(near.reduction) : result.reduction);
}

// Calls function(features, layers) with the numbers of components as compile-time constants.
template <class Function>
bool with_shapes(const Guide& guide, const Field& field, const Function& function) {
    const auto with = [&](auto features) {
        switch (field.values.components()) {
            case 2:
                return function(features, std::integral_constant<std::size_t, 2>());
            case 3:
                return function(features, std::integral_constant<std::size_t, 3>());
            case 4:
                return function(features, std::integral_constant<std::size_t, 4>());
            case 5:
                return function(features, std::integral_constant<std::size_t, 5>());
            default:
                return function(features, std::integral_constant<std::size_t, 6>());
        }
    };
    return guide.components() == 4 ? with(std::integral_constant<std::size_t, 4>())
                                   : with(std::integral_constant<std::size_t, 7>());
}

}  // namespace tessera::filter::pixel
