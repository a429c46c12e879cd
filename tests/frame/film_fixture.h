#pragma once

#include <bit>
#include <limits>
#include <vector>

#include "mediator/base/random.h"
#include "mediator/frame/merge.h"

namespace tessera::frame {

inline constexpr ChannelSet SomeChannels{Channel::Radiance,    Channel::Albedo,        Channel::Depth,
                                         Channel::ObjectIndex, Channel::BlockVariance, Channel::FirstHalf};
inline constexpr Rect SmallTile{4, 8, 5, 3};

// The film of one sample: a pure function of its index, as a back-end's is. Some samples are not finite, some
// depths tie, some object ids look like a signalling NaN.
inline FilmTile sample_film(std::uint64_t index) {
    FilmTile tile(SmallTile, {index, 0}, SomeChannels);
    CounterRandom random(99, index);
    for (std::size_t pixel = 0; pixel < tile.pixel_count(); ++pixel) {
        std::vector<float> values;
        for (int i = 0; i < 6; ++i) values.push_back(static_cast<float>(random.uniform() * 100.0));
        if (random.below(10) == 0) values[random.below(6)] = std::numeric_limits<float>::quiet_NaN();
        const auto depth = random.below(8) == 0 ? std::numeric_limits<float>::infinity()
                                                : static_cast<float>(random.below(5));
        values.push_back(depth);
        values.push_back(depth);
        values.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(0x7f800001u + index)));
        put_sample(tile, pixel, values);
    }
    return tile;
}

// The canonical film of a block: the merge of its two halves, down to the single sample.
inline FilmTile canonical_film(SampleBlock block) {
    if (block.level == 0) return sample_film(block.first);
    const SampleBlock half{block.first, block.level - 1};
    FilmTile film = canonical_film(half);
    merge(film, canonical_film(half.sibling()));
    return film;
}

}  // namespace tessera::frame
