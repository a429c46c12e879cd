#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mediator/base/rect.h"
#include "mediator/frame/channels.h"
#include "mediator/frame/pixel_set.h"
#include "mediator/frame/sample_block.h"

namespace tessera::frame {

// Statistics of one block of samples over some or all pixels of one tile: per pixel a count of accepted samples, and
// float32 planes, one after another, each in raster order. The only form in which samples are sent and merged.
class FilmTile {
  public:
    FilmTile() = default;
    FilmTile(Rect rect, SampleBlock block, ChannelSet channels, PixelSet pixels = {});  // no samples yet
    void reset(SampleBlock block);  // no samples again, in the same memory

    Rect rect;
    SampleBlock block;
    ChannelSet channels;
    PixelSet pixels;                    // of the rectangle; the others have no entries in counts and planes
    std::vector<std::uint32_t> counts;  // accepted samples per pixel; block.count() less the non-finite ones
    std::vector<float> planes;          // channels.plane_count() x pixel_count()
    std::uint64_t nonfinite_samples = 0;

    std::size_t pixel_count() const { return counts.size(); }
    std::span<float> plane(std::uint32_t index) {
        return {planes.data() + index * pixel_count(), pixel_count()};
    }
    std::span<const float> plane(std::uint32_t index) const {
        return {planes.data() + index * pixel_count(), pixel_count()};
    }
    std::size_t byte_size() const { return counts.size() * 4 + planes.size() * 4; }
};

// Copies the pixels of `tile` into `film`, which has all pixels of a rectangle that contains the tile's, and the same
// channels.
void paste(FilmTile& film, const FilmTile& tile);

// The same samples with fewer channels: `channels` is a subset of those of the tile.
FilmTile with_channels(const FilmTile& tile, ChannelSet channels);

// The samples of some pixels of a tile that has all of its rectangle.
FilmTile with_pixels(const FilmTile& tile, const PixelSet& pixels);

bool identical_bits(const FilmTile& a, const FilmTile& b);

}  // namespace tessera::frame
