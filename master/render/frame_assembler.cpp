#include "master/render/frame_assembler.h"

#include <algorithm>

namespace tessera::master {

FrameAssembler::FrameAssembler(std::vector<Rect> tiles, frame::ChannelSet channels, std::uint64_t spp)
    : tiles_(std::move(tiles)), channels_(channels), spp_(spp), films_(tiles_.size()) {
    for (std::uint32_t i = 0; i < tiles_.size(); ++i) by_corner_[{tiles_[i].x, tiles_[i].y}] = i;
}

FrameAssembler::Result FrameAssembler::insert(frame::FilmTile block, const BlockSet& replaceable) {
    const auto it = by_corner_.find({block.rect.x, block.rect.y});
    if (it == by_corner_.end() || tiles_[it->second] != block.rect || block.channels != channels_ ||
        !block.block.is_aligned() || block.block.end() > spp_) {
        return {};
    }
    const std::uint32_t tile = it->second;
    const auto may_replace = [&](const frame::SampleBlock& inside) { return replaceable.covers(inside); };
    switch (films_[tile].insert(std::move(block), may_replace)) {
        case frame::TileFilm::Outcome::Merged:
        case frame::TileFilm::Outcome::Replaced:
            return {Outcome::Merged, tile};
        case frame::TileFilm::Outcome::Duplicate:
            return {Outcome::Duplicate, tile};
        case frame::TileFilm::Outcome::Conflict:
            return {Outcome::Conflict, tile};
        case frame::TileFilm::Outcome::Overlap:
            return {Outcome::Overlap, tile};
    }
    return {};
}

void FrameAssembler::add_channels(frame::ChannelSet channels) {
    const frame::ChannelSet kept = earlier_.empty() ? channels_ : earlier_channels_;
    std::vector<frame::TileFilm> all(tiles_.size());
    for (std::uint32_t tile = 0; tile < tile_count(); ++tile) all[tile] = all_blocks(tile);
    earlier_ = std::move(all);
    earlier_channels_ = kept;
    channels_ = channels;
    films_.assign(tiles_.size(), {});
}

// All samples, with the channels that all of them have.
frame::TileFilm FrameAssembler::all_blocks(std::uint32_t tile) const {
    if (earlier_.empty()) return films_[tile];
    frame::TileFilm all = earlier_[tile];
    for (const frame::FilmTile& block : films_[tile].blocks(frame::TileFilm::Parts::Included))
        all.insert(frame::with_channels(block, earlier_channels_));
    return all;
}

frame::FilmTile FrameAssembler::merged_tile(std::uint32_t tile) const {
    if (earlier_.empty()) {
        if (!films_[tile].empty()) return films_[tile].merged();
    } else if (const frame::TileFilm all = all_blocks(tile); !all.empty()) {
        return all.merged();
    }
    return frame::FilmTile(tiles_[tile], {}, earlier_.empty() ? channels_ : earlier_channels_);
}

Rect FrameAssembler::bounds() const {
    Rect bounds = tiles_.front();
    for (const Rect& tile : tiles_) {
        const std::int32_t right = std::max(bounds.right(), tile.right());
        const std::int32_t bottom = std::max(bounds.bottom(), tile.bottom());
        bounds.x = std::min(bounds.x, tile.x);
        bounds.y = std::min(bounds.y, tile.y);
        bounds.width = right - bounds.x;
        bounds.height = bottom - bounds.y;
    }
    return bounds;
}

std::vector<std::uint8_t> FrameAssembler::doublings() const {
    const Rect all = bounds();
    std::vector<std::uint8_t> doublings(all.pixel_count(), 255);
    for (std::uint32_t tile = 0; tile < tile_count(); ++tile) {
        const std::vector<std::uint8_t> of_tile = this->doublings(tile);
        if (of_tile.empty()) continue;
        const Rect& rect = tiles_[tile];
        for (std::int32_t row = 0; row < rect.height; ++row) {
            const auto from = of_tile.begin() + std::ptrdiff_t{row} * rect.width;
            std::copy_n(
                from, rect.width,
                doublings.begin() + std::ptrdiff_t{rect.y + row - all.y} * all.width + (rect.x - all.x));
        }
    }
    return doublings;
}

template <class PasteTile>
frame::FilmTile FrameAssembler::pasted(frame::ChannelSet channels, const PasteTile& paste_tile) const {
    frame::FilmTile film(bounds(), {}, channels);
    for (std::uint32_t tile = 0; tile < tile_count(); ++tile) paste_tile(tile, film);
    return film;
}

frame::FilmTile FrameAssembler::whole() const {
    return pasted(earlier_.empty() ? channels_ : earlier_channels_,
                  [&](std::uint32_t tile, frame::FilmTile& film) {
                      // The usual case, without an intermediate copy.
                      const frame::FilmTile* block = earlier_.empty() ? films_[tile].only_block() : nullptr;
                      block != nullptr ? frame::paste(film, *block) : frame::paste(film, merged_tile(tile));
                  });
}

std::optional<frame::FilmTile> FrameAssembler::later() const {
    if (earlier_.empty()) return std::nullopt;
    return pasted(channels_, [&](std::uint32_t tile, frame::FilmTile& film) {
        if (!films_[tile].empty()) frame::paste(film, films_[tile].merged());
    });
}

std::vector<frame::FilmTile> FrameAssembler::blocks() const {
    std::vector<frame::FilmTile> all;
    for (const frame::TileFilm& film : films_) {
        for (frame::FilmTile& block : film.blocks(frame::TileFilm::Parts::LeftOut))
            all.push_back(std::move(block));
    }
    return all;
}

std::uint64_t FrameAssembler::byte_size() const {
    std::uint64_t bytes = 0;
    for (const auto* films : {&films_, &earlier_}) {
        for (const frame::TileFilm& film : *films) bytes += film.byte_size();
    }
    return bytes;
}

}  // namespace tessera::master
