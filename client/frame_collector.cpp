#include "client/frame_collector.h"

#include <algorithm>

namespace tessera::client {

namespace {

// All tiles in one; they cover a rectangle.
Expected<frame::FilmTile> pasted(const std::vector<frame::FilmTile>& tiles) {
    Rect bounds = tiles.front().rect;
    std::size_t pixels = 0;
    for (const frame::FilmTile& tile : tiles) {
        const std::int32_t right = std::max(bounds.right(), tile.rect.right());
        const std::int32_t bottom = std::max(bounds.bottom(), tile.rect.bottom());
        bounds.x = std::min(bounds.x, tile.rect.x);
        bounds.y = std::min(bounds.y, tile.rect.y);
        bounds.width = right - bounds.x;
        bounds.height = bottom - bounds.y;
        pixels += tile.rect.pixel_count();
        if (tile.channels != tiles.front().channels)
            return failure(ErrorCode::InvalidInput, "the master sent tiles with different channels");
    }
    if (pixels != bounds.pixel_count())
        return failure(ErrorCode::InvalidInput, "the master sent tiles that do not fit together");
    frame::FilmTile film(bounds, {}, tiles.front().channels);
    for (const frame::FilmTile& tile : tiles) frame::paste(film, tile);
    return film;
}

}  // namespace

void FrameCollector::begin(const wire::LiveFrame& header) {
    header_ = header;
    picture_ = PictureCollector(JobId{header.frame});
    tiles_.clear();
}

Expected<void> FrameCollector::add(wire::PictureChunk&& chunk) {
    if (!header_) return {};
    if (chunk.total != header_->picture_bytes && chunk.job.value == header_->frame)
        return failure(ErrorCode::InvalidInput, "the master sent a picture of another size than it said");
    return picture_.add(std::move(chunk));
}

Expected<void> FrameCollector::add(wire::FrameTile&& tile) {
    if (!header_ || tile.job.value != header_->frame) return {};
    if (tiles_.size() >= header_->film_tiles)
        return failure(ErrorCode::InvalidInput, "the master sent more tiles than it said");
    tiles_.push_back(std::move(tile.film));
    return {};
}

std::optional<Frame> FrameCollector::take() {
    if (!header_ || picture_.byte_size() < header_->picture_bytes || tiles_.size() < header_->film_tiles)
        return std::nullopt;
    const wire::LiveFrame header = *std::exchange(header_, std::nullopt);
    Frame frame{.view = header.view,
                .number = header.frame,
                .version = header.version,
                .revision = header.revision,
                .scale = header.scale,
                .width = header.width,
                .height = header.height,
                .components = header.components,
                .encoding = header.encoding,
                .picture = picture_.take(),
                .film = {},
                .samples_least = header.samples_least,
                .samples_most = header.samples_most,
                .spp = header.spp,
                .complete = header.complete,
                .film_hash = header.film_hash};
    if (!tiles_.empty()) {
        auto film = pasted(tiles_);
        if (!film) throw film.error();
        frame.film = std::move(*film);
    }
    tiles_.clear();
    return frame;
}

}  // namespace tessera::client
