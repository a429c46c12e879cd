#include "mediator/frame/film_tile.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace tessera::frame {

namespace {

void fill_empty(FilmTile& tile, const ChannelInfo& info) {
    constexpr float Infinity = std::numeric_limits<float>::infinity();
    const std::uint32_t first = tile.channels.first_plane(info.channel);
    const auto fill = [&](std::uint32_t plane, float value) {
        const std::span<float> values = tile.plane(first + plane);
        std::fill(values.begin(), values.end(), value);
    };
    if (info.rule == MergeRule::Nearest) fill(0, Infinity);
    for (std::uint32_t c = 0; c < info.components; ++c) {
        if (info.rule == MergeRule::Minimum) fill(c, Infinity);
        if (info.rule == MergeRule::Maximum) fill(c, -Infinity);
    }
}

// Sets the values of a tile without samples that are not 0.
void fill_empty(FilmTile& tile) {
    for (const ChannelInfo& info : channel_table()) {
        if (tile.channels.contains(info.channel)) fill_empty(tile, info);
    }
}

// Copies the rows of a tile's plane into the window's plane.
template <class T>
void copy_rows(std::span<const T> from, const Rect& tile, std::span<T> to, const Rect& window) {
    for (std::int32_t row = 0; row < tile.height; ++row) {
        const auto source = from.subspan(static_cast<std::size_t>(row) * static_cast<std::size_t>(tile.width),
                                         static_cast<std::size_t>(tile.width));
        const std::size_t offset =
            static_cast<std::size_t>(tile.y + row - window.y) * static_cast<std::size_t>(window.width) +
            static_cast<std::size_t>(tile.x - window.x);
        std::copy(source.begin(), source.end(), to.begin() + static_cast<std::ptrdiff_t>(offset));
    }
}

// The same for some pixels of the tile.
template <class T>
void copy_pixels(std::span<const T> from, const PixelSet& pixels, const Rect& tile, std::span<T> to,
                 const Rect& window) {
    const auto tile_width = static_cast<std::uint32_t>(tile.width),
               width = static_cast<std::uint32_t>(window.width);
    const auto corner =
        static_cast<std::size_t>(tile.y - window.y) * width + static_cast<std::size_t>(tile.x - window.x);
    std::size_t next = 0;
    for (const std::uint32_t index : pixels.indices()) {
        const std::size_t at = corner + std::size_t{index / tile_width} * width + index % tile_width;
        std::memcpy(&to[at], &from[next++], sizeof(T));  // bits: a payload may look like a signalling NaN
    }
}

template <class T>
void copy(std::span<const T> from, const FilmTile& tile, std::span<T> to, const Rect& window) {
    tile.pixels.is_all() ? copy_rows(from, tile.rect, to, window)
                         : copy_pixels(from, tile.pixels, tile.rect, to, window);
}

}  // namespace

FilmTile::FilmTile(Rect tile_rect, SampleBlock sample_block, ChannelSet channel_set, PixelSet pixel_set)
    : rect(tile_rect),
      block(sample_block),
      channels(channel_set),
      pixels(std::move(pixel_set)),
      counts(pixels.count(tile_rect.pixel_count()), 0),
      planes(channel_set.plane_count() * counts.size()) {
    fill_empty(*this);
}

void FilmTile::reset(SampleBlock sample_block) {
    block = sample_block;
    nonfinite_samples = 0;
    std::fill(counts.begin(), counts.end(), 0u);
    std::fill(planes.begin(), planes.end(), 0.0f);
    fill_empty(*this);
}

void paste(FilmTile& film, const FilmTile& tile) {
    copy<std::uint32_t>(tile.counts, tile, film.counts, film.rect);
    for (std::uint32_t plane = 0; plane < tile.channels.plane_count(); ++plane) {
        copy<float>(tile.plane(plane), tile, film.plane(plane), film.rect);
    }
    film.nonfinite_samples += tile.nonfinite_samples;
}

FilmTile with_channels(const FilmTile& tile, ChannelSet channels) {
    FilmTile result(tile.rect, tile.block, channels, tile.pixels);
    result.counts = tile.counts;
    result.nonfinite_samples = tile.nonfinite_samples;
    for (const ChannelInfo& entry : channel_table()) {
        if (!channels.contains(entry.channel)) continue;
        const std::uint32_t from = tile.channels.first_plane(entry.channel),
                            to = channels.first_plane(entry.channel);
        for (std::uint32_t plane = 0; plane < entry.plane_count(); ++plane) {
            const auto values = tile.plane(from + plane);
            std::copy(values.begin(), values.end(), result.plane(to + plane).begin());
        }
    }
    return result;
}

FilmTile with_pixels(const FilmTile& tile, const PixelSet& pixels) {
    FilmTile result(tile.rect, tile.block, tile.channels, pixels);
    for (std::size_t i = 0; i < result.pixel_count(); ++i) result.counts[i] = tile.counts[pixels.index(i)];
    for (std::uint32_t plane = 0; plane < tile.channels.plane_count(); ++plane) {
        const std::span<const float> from = tile.plane(plane);
        const std::span<float> to = result.plane(plane);
        for (std::size_t i = 0; i < to.size(); ++i)
            std::memcpy(&to[i], &from[pixels.index(i)], sizeof(float));
    }
    return result;
}

bool identical_bits(const FilmTile& a, const FilmTile& b) {
    return a.rect == b.rect && a.channels == b.channels && a.pixels == b.pixels && a.counts == b.counts &&
           a.nonfinite_samples == b.nonfinite_samples && a.planes.size() == b.planes.size() &&
           std::memcmp(a.planes.data(), b.planes.data(), a.planes.size() * sizeof(float)) == 0;
}

}  // namespace tessera::frame
