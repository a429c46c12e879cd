#include "client/film_collector.h"

#include <algorithm>

namespace tessera::client {

FilmCollector::FilmCollector(JobId job, Rect window, frame::ChannelSet channels)
    : job_(job), wanted_(channels), film_(window, {}, channels) {}

Expected<void> FilmCollector::add(const wire::FrameTile& tile) {
    if (tile.job != job_) return {};
    const frame::FilmTile& part = tile.film;
    if (part.rect.empty() || intersection(part.rect, film_.rect) != part.rect ||
        (wanted_.bits() & ~part.channels.bits()) != 0 || (count_ > 0 && part.channels != film_.channels)) {
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
    // The channels of the filter, which the master knows, come on top of those that were asked for.
    if (count_ == 1) film_ = frame::FilmTile(film_.rect, {}, part.channels);
    frame::paste(film_, part);
    return {};
}

}  // namespace tessera::client
