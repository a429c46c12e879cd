#include "client/film_collector.h"

#include <algorithm>

namespace tessera::client {

namespace {

// Copies the rows of a tile's plane to their place in the window's plane.
template <class T>
void place(std::span<const T> from, const Rect& tile, std::span<T> to, const Rect& window) {
    for (std::int32_t row = 0; row < tile.height; ++row) {
        const auto source = from.subspan(static_cast<std::size_t>(row) * static_cast<std::size_t>(tile.width),
                                         static_cast<std::size_t>(tile.width));
        const std::size_t offset =
            static_cast<std::size_t>(tile.y + row - window.y) * static_cast<std::size_t>(window.width) +
            static_cast<std::size_t>(tile.x - window.x);
        std::copy(source.begin(), source.end(), to.begin() + static_cast<std::ptrdiff_t>(offset));
    }
}

}  // namespace

FilmCollector::FilmCollector(JobId job, Rect window, frame::ChannelSet channels)
    : job_(job), film_(window, {}, channels) {}

Expected<void> FilmCollector::add(const wire::FrameTile& tile) {
    if (tile.job != job_) return {};
    const frame::FilmTile& part = tile.film;
    if (part.rect.empty() || intersection(part.rect, film_.rect) != part.rect ||
        part.channels != film_.channels) {
        return failure(ErrorCode::InvalidInput,
                       "the master sent a tile that does not fit the picture: check that "
                       "master and client are of the same version");
    }
    if (tile.index >= tile.count || tile.count > film_.pixel_count()) {
        return failure(ErrorCode::InvalidInput, "the master sent a tile with a number beyond its count");
    }
    if (seen_.size() <= tile.index) seen_.resize(tile.index + std::size_t{1});
    if (seen_[tile.index]) return {};
    seen_[tile.index] = true;
    ++count_;
    place<std::uint32_t>(part.counts, part.rect, film_.counts, film_.rect);
    for (std::uint32_t plane = 0; plane < part.channels.plane_count(); ++plane) {
        place<float>(part.plane(plane), part.rect, film_.plane(plane), film_.rect);
    }
    film_.nonfinite_samples += part.nonfinite_samples;
    return {};
}

}  // namespace tessera::client
