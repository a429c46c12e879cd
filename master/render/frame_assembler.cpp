#include "master/render/frame_assembler.h"

#include <algorithm>

namespace tessera::master {

FrameAssembler::FrameAssembler(std::vector<Rect> tiles, frame::ChannelSet channels, std::uint64_t spp)
    : tiles_(std::move(tiles)), channels_(channels), spp_(spp), forests_(tiles_.size()) {
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
    switch (forests_[tile].insert(std::move(block), may_replace)) {
        case frame::BlockForest::Outcome::Merged:
        case frame::BlockForest::Outcome::Replaced:
            return {Outcome::Merged, tile};
        case frame::BlockForest::Outcome::Duplicate:
            return {Outcome::Duplicate, tile};
        case frame::BlockForest::Outcome::Conflict:
            return {Outcome::Conflict, tile};
        case frame::BlockForest::Outcome::Overlap:
            return {Outcome::Overlap, tile};
    }
    return {};
}

void FrameAssembler::add_channels(frame::ChannelSet channels) {
    const frame::ChannelSet kept = earlier_.empty() ? channels_ : earlier_channels_;
    std::vector<frame::BlockForest> all(tiles_.size());
    for (std::uint32_t tile = 0; tile < tile_count(); ++tile) all[tile] = all_blocks(tile);
    earlier_ = std::move(all);
    earlier_channels_ = kept;
    channels_ = channels;
    forests_.assign(tiles_.size(), {});
}

// All samples, with the channels that all of them have.
frame::BlockForest FrameAssembler::all_blocks(std::uint32_t tile) const {
    if (earlier_.empty()) return forests_[tile];
    frame::BlockForest all = earlier_[tile];
    for (const auto& [first, block] : forests_[tile].blocks())
        all.insert(frame::with_channels(block, earlier_channels_));
    return all;
}

frame::FilmTile FrameAssembler::merged_tile(std::uint32_t tile) const {
    if (earlier_.empty()) {
        if (!forests_[tile].blocks().empty()) return forests_[tile].merged();
    } else if (const frame::BlockForest all = all_blocks(tile); !all.blocks().empty()) {
        return all.merged();
    }
    return frame::FilmTile(tiles_[tile], {}, earlier_.empty() ? channels_ : earlier_channels_);
}

template <class PasteTile>
frame::FilmTile FrameAssembler::pasted(frame::ChannelSet channels, const PasteTile& paste_tile) const {
    Rect bounds = tiles_.front();
    for (const Rect& tile : tiles_) {
        const std::int32_t right = std::max(bounds.right(), tile.right());
        const std::int32_t bottom = std::max(bounds.bottom(), tile.bottom());
        bounds.x = std::min(bounds.x, tile.x);
        bounds.y = std::min(bounds.y, tile.y);
        bounds.width = right - bounds.x;
        bounds.height = bottom - bounds.y;
    }
    frame::FilmTile film(bounds, {}, channels);
    for (std::uint32_t tile = 0; tile < tile_count(); ++tile) paste_tile(tile, film);
    return film;
}

frame::FilmTile FrameAssembler::whole() const {
    return pasted(earlier_.empty() ? channels_ : earlier_channels_,
                  [&](std::uint32_t tile, frame::FilmTile& film) {
                      // The usual case, without an intermediate copy.
                      const bool is_one_block = earlier_.empty() && forests_[tile].blocks().size() == 1;
                      is_one_block ? frame::paste(film, forests_[tile].blocks().begin()->second)
                                   : frame::paste(film, merged_tile(tile));
                  });
}

std::optional<frame::FilmTile> FrameAssembler::later() const {
    if (earlier_.empty()) return std::nullopt;
    return pasted(channels_, [&](std::uint32_t tile, frame::FilmTile& film) {
        if (!forests_[tile].blocks().empty()) frame::paste(film, forests_[tile].merged());
    });
}

std::vector<frame::FilmTile> FrameAssembler::blocks() const {
    std::vector<frame::FilmTile> all;
    for (const auto& forest : forests_) {
        for (const auto& [first, block] : forest.blocks()) all.push_back(block);
    }
    return all;
}

std::uint64_t FrameAssembler::byte_size() const {
    std::uint64_t bytes = 0;
    for (const auto* forests : {&forests_, &earlier_}) {
        for (const auto& forest : *forests) {
            for (const auto& [first, block] : forest.blocks()) bytes += block.byte_size();
        }
    }
    return bytes;
}

}  // namespace tessera::master
