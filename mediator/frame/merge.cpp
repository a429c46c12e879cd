#include "mediator/frame/merge.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

namespace tessera::frame {

namespace {

// Equal counts allow a cheaper merge.
struct Counts {
    std::span<const std::uint32_t> into, later;
    bool equal_everywhere = true;  // and not 0: siblings without a rejected sample
    Counts(const FilmTile& a, const FilmTile& b) : into(a.counts), later(b.counts) {
        const std::uint32_t n = into.empty() ? 0 : into[0];
        std::uint32_t differing = n == 0 ? 1u : 0u;
        for (std::size_t i = 0; i < into.size(); ++i) differing |= (into[i] ^ n) | (later[i] ^ n);
        equal_everywhere = differing == 0;
    }
};

void merge_equal_moments(std::span<float> mean, std::span<float> m2, std::span<const float> later_mean,
                         std::span<const float> later_m2, std::uint32_t n) {
    const float half_n = 0.5f * static_cast<float>(n);
    for (std::size_t i = 0; i < mean.size(); ++i) {
        const float difference = mean[i] - later_mean[i];
        m2[i] = (m2[i] + later_m2[i]) + (difference * difference) * half_n;
        mean[i] = (mean[i] + later_mean[i]) * 0.5f;
    }
}

void merge_moments(FilmTile& into, const FilmTile& later, std::uint32_t first, std::uint32_t components,
                   const Counts& counts) {
    for (std::uint32_t c = 0; c < components; ++c) {
        const std::span<float> mean = into.plane(first + c), m2 = into.plane(first + components + c);
        const std::span<const float> later_mean = later.plane(first + c);
        const std::span<const float> later_m2 = later.plane(first + components + c);
        if (counts.equal_everywhere) {
            merge_equal_moments(mean, m2, later_mean, later_m2, counts.into[0]);
            continue;
        }
        for (std::size_t i = 0; i < mean.size(); ++i) {
            const auto both = merged<float>({counts.into[i], mean[i], m2[i]},
                                            {counts.later[i], later_mean[i], later_m2[i]});
            mean[i] = both.mean;
            m2[i] = both.m2;
        }
    }
}

// Copies bits: a payload may look like a signalling NaN.
void copy_value(std::span<float> into, std::span<const float> from, std::size_t pixel) {
    std::memcpy(&into[pixel], &from[pixel], sizeof(float));
}

void merge_nearest(FilmTile& into, const FilmTile& later, std::uint32_t first, std::uint32_t components) {
    const std::span<const float> key = into.plane(first), later_key = later.plane(first);
    for (std::size_t i = 0; i < key.size(); ++i) {
        if (!(later_key[i] < key[i])) continue;
        for (std::uint32_t c = components; c-- > 0;)
            copy_value(into.plane(first + c), later.plane(first + c), i);
    }
}

void merge_first(FilmTile& into, const FilmTile& later, std::uint32_t first, std::uint32_t components) {
    for (std::size_t i = 0; i < into.pixel_count(); ++i) {
        if (into.counts[i] != 0 || later.counts[i] == 0) continue;
        for (std::uint32_t c = 0; c < components; ++c)
            copy_value(into.plane(first + c), later.plane(first + c), i);
    }
}

template <class Choose>
void merge_values(FilmTile& into, const FilmTile& later, std::uint32_t first, std::uint32_t components,
                  const Choose& choose) {
    for (std::uint32_t c = 0; c < components; ++c) {
        const std::span<float> values = into.plane(first + c);
        const std::span<const float> others = later.plane(first + c);
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = choose(values[i], others[i]);
    }
}

// The means of a film's radiance.
struct Radiances {
    std::array<std::span<const float>, 3> planes;
    explicit Radiances(const FilmTile& film) {
        const std::uint32_t first = film.channels.first_plane(Channel::Radiance);
        for (std::uint32_t c = 0; c < 3; ++c) planes[c] = film.plane(first + c);
    }
};

// As in shaders/merge.comp.
float squared_difference(const Radiances& a, const Radiances& b, std::size_t pixel) {
    constexpr std::array Weights{0.2126f, 0.7152f, 0.0722f};
    float sum = 0.0f;
    for (std::size_t c = 0; c < 3; ++c) {
        const float difference = a.planes[c][pixel] - b.planes[c][pixel];
        sum += Weights[c] * (difference * difference);
    }
    return sum;
}

// Errors of the means of two blocks that are merged, and of the halves of those blocks.
struct BlockErrors {
    float top, below;
};

BlockErrors merged_siblings(BlockErrors a, float na, BlockErrors b, float nb, float square) {
    if (na == nb) return {0.25f * square, 0.5f * (a.top + b.top)};
    const float wa = na / (na + nb), wb = nb / (na + nb);
    return {wa * wb * square, wa * a.top + wb * b.top};
}

BlockErrors merged_roots(BlockErrors a, float na, BlockErrors b, float nb, float square) {
    if (na == 1.0f && nb == 1.0f) return {0.25f * square, 0.0f};
    if (na == 1.0f) a = {nb * b.top, nb * b.below};
    if (nb == 1.0f) b = {na * a.top, na * a.below};
    const float wa = na / (na + nb), wb = nb / (na + nb);
    return {wa * wa * a.top + wb * wb * b.top, wa * wa * a.below + wb * wb * b.below};
}

void merge_block_variance(FilmTile& into, const FilmTile& later, std::uint32_t first, const Counts& counts,
                          bool are_siblings) {
    const std::span<float> top = into.plane(first), below = into.plane(first + 1);
    const std::span<const float> later_top = later.plane(first), later_below = later.plane(first + 1);
    const Radiances a(into), b(later);
    if (are_siblings && counts.equal_everywhere) {
        for (std::size_t i = 0; i < top.size(); ++i) {
            below[i] = 0.5f * (top[i] + later_top[i]);
            top[i] = 0.25f * squared_difference(a, b, i);
        }
        return;
    }
    for (std::size_t i = 0; i < top.size(); ++i) {
        if (later.counts[i] == 0) continue;
        BlockErrors both{later_top[i], later_below[i]};
        if (into.counts[i] != 0) {
            const auto merged = are_siblings ? merged_siblings : merged_roots;
            both = merged({top[i], below[i]}, static_cast<float>(into.counts[i]), both,
                          static_cast<float>(later.counts[i]), squared_difference(a, b, i));
        }
        top[i] = both.top;
        below[i] = both.below;
    }
}

void merge_first_half(FilmTile& into, const FilmTile& later, std::uint32_t first, bool are_siblings) {
    const std::span<float> count = into.plane(first + 3);
    if (are_siblings) {
        const Radiances all(into);
        for (std::uint32_t c = 0; c < 3; ++c) std::ranges::copy(all.planes[c], into.plane(first + c).begin());
        for (std::size_t i = 0; i < count.size(); ++i) count[i] = static_cast<float>(into.counts[i]);
        return;
    }
    const std::span<const float> more = later.plane(first + 3);
    for (std::size_t i = 0; i < count.size(); ++i) {
        if (!(more[i] > 0.0f)) continue;
        const float share = more[i] / (count[i] + more[i]);
        for (std::uint32_t c = 0; c < 3; ++c) {
            float& mean = into.plane(first + c)[i];
            mean -= (mean - later.plane(first + c)[i]) * share;
        }
        count[i] += more[i];
    }
}

void merge_channel(FilmTile& into, const FilmTile& later, const ChannelInfo& info, const Counts& counts,
                   bool are_siblings) {
    const std::uint32_t first = into.channels.first_plane(info.channel), components = info.components;
    switch (info.rule) {
        case MergeRule::Moments:
            return merge_moments(into, later, first, components, counts);
        case MergeRule::Sum:
            return merge_values(into, later, first, components, [](float a, float b) { return a + b; });
        case MergeRule::Minimum:
            return merge_values(into, later, first, components,
                                [](float a, float b) { return b < a ? b : a; });
        case MergeRule::Maximum:
            return merge_values(into, later, first, components,
                                [](float a, float b) { return b > a ? b : a; });
        case MergeRule::Nearest:
            return merge_nearest(into, later, first, components);
        case MergeRule::First:
            return merge_first(into, later, first, components);
        case MergeRule::BlockVariance:
            return merge_block_variance(into, later, first, counts, are_siblings);
        case MergeRule::FirstHalf:
            return merge_first_half(into, later, first, are_siblings);
    }
}

// What a sample without a value has: the neutral element of the rule.
float neutral(MergeRule rule, std::uint32_t component) {
    constexpr float Infinity = std::numeric_limits<float>::infinity();
    if (component > 0 && rule == MergeRule::Nearest) return 0.0f;
    if (rule == MergeRule::Minimum || rule == MergeRule::Nearest) return Infinity;
    return rule == MergeRule::Maximum ? -Infinity : 0.0f;
}

bool has_value(const ChannelInfo& info, std::span<const float> values) {
    for (std::uint32_t c = 0; c < info.value_count(); ++c) {
        const bool is_sum = info.rule == MergeRule::Moments || info.rule == MergeRule::Sum;
        if (is_sum && !std::isfinite(values[c])) return false;
        const bool is_payload = c > 0 || info.rule == MergeRule::First;
        if (!is_payload && std::isnan(values[c])) return false;
    }
    return true;
}

}  // namespace

void put_sample(FilmTile& tile, std::size_t pixel, std::span<const float> values) {
    std::size_t next = 0;
    std::uint32_t plane = 0;
    const bool is_counted = tile.channels.for_each([&](const ChannelInfo& info) {
        const bool is_valid = has_value(info, values.subspan(next, info.value_count()));
        if (info.channel == Channel::Radiance && !is_valid) return false;
        for (std::uint32_t c = 0; c < info.value_count(); ++c, ++next) {
            // As bits: ids may look like a NaN.
            const float other = neutral(info.rule, c);
            std::memcpy(&tile.plane(plane + c)[pixel], is_valid ? &values[next] : &other, sizeof(float));
        }
        plane += info.plane_count();  // M2 of a single sample stays 0, as do channels without values
        return true;
    });
    if (is_counted) {
        tile.counts[pixel] = 1;
    } else {
        ++tile.nonfinite_samples;
    }
}

void merge(FilmTile& into, const FilmTile& later) {
    assert(into.rect == later.rect && into.pixels == later.pixels && into.channels == later.channels &&
           into.block.end() <= later.block.first);
    const Counts counts(into, later);
    const bool are_siblings = into.block.sibling() == later.block;
    // Derived channels need the means before they are merged.
    for (const bool is_derived : {true, false}) {
        into.channels.for_each([&](const ChannelInfo& info) {
            if (info.is_derived() == is_derived) merge_channel(into, later, info, counts, are_siblings);
            return true;
        });
    }
    for (std::size_t i = 0; i < into.counts.size(); ++i) into.counts[i] += later.counts[i];
    into.nonfinite_samples += later.nonfinite_samples;
    if (are_siblings) {
        into.block = into.block.parent();
    } else {
        // Merged roots that are no siblings form no block; the end is kept so that the order of merges can be checked.
        into.block = {later.block.end() - 1, 0};
    }
}

template <class Real>
Moments<Real> merged(const Moments<Real>& a, const Moments<Real>& b) {
    if (a.n == 0) return b;
    if (b.n == 0) return a;
    const Real difference = a.mean - b.mean;
    if (a.n == b.n) {
        return {a.n + b.n, (a.mean + b.mean) * Real(0.5),
                (a.m2 + b.m2) + (difference * difference) * (Real(0.5) * static_cast<Real>(a.n))};
    }
    const Real na = static_cast<Real>(a.n), nb = static_cast<Real>(b.n), n = na + nb;
    return {a.n + b.n, a.mean - difference * (nb / n),
            (a.m2 + b.m2) + (difference * difference) * (na * (nb / n))};
}

template Moments<float> merged(const Moments<float>&, const Moments<float>&);
template Moments<double> merged(const Moments<double>&, const Moments<double>&);

}  // namespace tessera::frame
