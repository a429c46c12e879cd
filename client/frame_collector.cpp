#include "client/frame_collector.h"

#include <algorithm>

namespace tessera::client {

namespace {

constexpr std::uint64_t MaxPictureBytes = std::uint64_t{1}
                                          << 33;  // 2^28 pixels of four floats and room for a header
constexpr std::size_t FilmAhead = 8;              // the whole film is allocated once 1/8 of it has arrived

tl::unexpected<Error> unfit(const char* what) {
    return failure(ErrorCode::InvalidInput, std::string("the master sent ") + what +
                                                ": check that master and client are of the same version");
}

}  // namespace

void FrameCollector::begin(const wire::FrameHeader& header) {
    *this = {};
    header_ = header;
    seen_.resize(header.film_tiles);
}

Expected<void> FrameCollector::add(wire::PictureChunk&& chunk) {
    if (!header_ || chunk.frame != header_->frame) return {};
    if (chunk.total != header_->picture_bytes || chunk.total > MaxPictureBytes)
        return unfit("a picture whose size differs from its header");
    if (chunk.offset != picture_.size()) return unfit("a picture with a gap");
    picture_.insert(picture_.end(), chunk.data.begin(), chunk.data.end());
    return {};
}

Expected<void> FrameCollector::add(wire::FrameTile&& tile) {
    if (!header_ || tile.frame != header_->frame) return {};
    const frame::FilmTile& film = tile.film;
    const frame::ChannelSet channels = film_            ? film_->channels
                                       : tiles_.empty() ? film.channels
                                                        : tiles_.front().channels;
    if (tile.count != header_->film_tiles || tile.index >= seen_.size())
        return unfit("a tile with a number beyond its count");
    if (seen_[tile.index]) return {};
    if (intersection(film.rect, header_->film_window) != film.rect || film.channels != channels ||
        !film.pixels.is_all())
        return unfit("a tile that does not fit the frame");
    seen_[tile.index] = true;
    ++tile_count_;
    pixel_count_ += film.rect.pixel_count();
    const std::size_t whole = header_->film_window.pixel_count();
    const bool is_last = tile_count_ == header_->film_tiles;
    if (pixel_count_ > whole || (is_last && pixel_count_ != whole))
        return unfit("overlapping or missing tiles");
    if (film_) {
        frame::paste(*film_, film);
        return {};
    }
    tiles_.push_back(std::move(tile.film));
    if (pixel_count_ * FilmAhead < whole) return {};
    film_.emplace(header_->film_window, frame::SampleBlock{}, channels);
    for (const frame::FilmTile& part : std::exchange(tiles_, {})) frame::paste(*film_, part);
    return {};
}

Expected<void> FrameCollector::add(wire::FilmBlock&& block) {
    if (!header_ || block.frame != header_->frame) return {};
    frame::FilmTile& film = block.film;
    const bool is_next =
        !tile_ || (block.index == tile_->index && block.left + 1 == tile_->left && film.rect == tile_->rect);
    if (!is_next) return unfit("blocks of film with a gap");
    if (!tile_)
        tile_.emplace(BlocksOfTile{.index = block.index, .rect = film.rect, .channels = film.channels});
    tile_->left = block.left;
    if (!state_) state_.emplace();
    if (!block.is_wanted) {
        if (film.channels != tile_->channels ||
            tile_->film.insert(std::move(film)) != frame::TileFilm::Outcome::Merged)
            return unfit("blocks of film that overlap");
    } else if (film.block.first > 0) {  // else the tile has no samples
        state_->wanted.push_back({film.rect, film.block, std::move(film.pixels)});
    }
    if (block.left > 0) return {};
    const BlocksOfTile tile = *std::exchange(tile_, std::nullopt);
    for (frame::FilmTile& whole : tile.film.blocks(frame::TileFilm::Parts::LeftOut))
        state_->blocks.push_back(std::move(whole));
    return add(wire::FrameTile{
        .frame = block.frame,
        .index = tile.index,
        .count = block.count,
        .film = tile.film.empty() ? frame::FilmTile(tile.rect, {}, tile.channels) : tile.film.merged()});
}

std::optional<Frame> FrameCollector::take() {
    if (!header_ || picture_.size() < header_->picture_bytes || tile_count_ < header_->film_tiles)
        return std::nullopt;
    const wire::FrameHeader header = *std::exchange(header_, std::nullopt);
    return Frame{.view = header.view,
                 .number = header.frame,
                 .version = header.version,
                 .revision = header.revision,
                 .scale = header.scale,
                 .width = header.width,
                 .height = header.height,
                 .components = header.components,
                 .encoding = header.encoding,
                 .picture = std::move(picture_),
                 .film = std::exchange(film_, std::nullopt),
                 .film_state = std::exchange(state_, std::nullopt),
                 .min_samples = header.min_samples,
                 .max_samples = header.max_samples,
                 .spp = header.spp,
                 .mean_samples = header.mean_samples,
                 .noise = header.noise,
                 .complete = header.complete,
                 .film_hash = header.film_hash};
}

}  // namespace tessera::client
