#include "master/frame_assembler.h"

#include <algorithm>

namespace tessera::master {

FrameAssembler::FrameAssembler(std::vector<Rect> tiles, frame::ChannelSet channels, std::uint64_t spp)
    : tiles_(std::move(tiles)), channels_(channels), spp_(spp), forests_(tiles_.size()) {
    for (std::uint32_t i = 0; i < tiles_.size(); ++i) by_corner_[{tiles_[i].x, tiles_[i].y}] = i;
}

FrameAssembler::Result FrameAssembler::insert(frame::FilmTile block) {
    const auto place = by_corner_.find({block.rect.x, block.rect.y});
    if (place == by_corner_.end() || tiles_[place->second] != block.rect || block.channels != channels_ ||
        !block.block.is_aligned() || block.block.end() > spp_) {
        return {};
    }
    const std::uint32_t tile = place->second;
    switch (forests_[tile].insert(std::move(block))) {
        case frame::BlockForest::Outcome::Merged:
        case frame::BlockForest::Outcome::Replaced:
            return {Outcome::Merged, tile};
        case frame::BlockForest::Outcome::Duplicate:
            return {Outcome::Duplicate, tile};
        case frame::BlockForest::Outcome::Contradiction:
            return {Outcome::Contradiction, tile};
    }
    return {};
}

frame::FilmTile FrameAssembler::merged_tile(std::uint32_t tile) const {
    if (forests_[tile].blocks().empty()) return frame::FilmTile(tiles_[tile], {}, channels_);
    return forests_[tile].merged();
}

frame::FilmTile FrameAssembler::whole() const {
    Rect bounds = tiles_.front();
    for (const Rect& tile : tiles_) {
        const std::int32_t right = std::max(bounds.right(), tile.right());
        const std::int32_t bottom = std::max(bounds.bottom(), tile.bottom());
        bounds.x = std::min(bounds.x, tile.x);
        bounds.y = std::min(bounds.y, tile.y);
        bounds.width = right - bounds.x;
        bounds.height = bottom - bounds.y;
    }
    frame::FilmTile film(bounds, {}, channels_);
    for (std::uint32_t i = 0; i < tile_count(); ++i) frame::paste(film, merged_tile(i));
    return film;
}

std::uint64_t FrameAssembler::byte_size() const {
    std::uint64_t bytes = 0;
    for (const auto& forest : forests_) {
        for (const auto& [first, block] : forest.blocks()) bytes += block.byte_size();
    }
    return bytes;
}

}  // namespace tessera::master
