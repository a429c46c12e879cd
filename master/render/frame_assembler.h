#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "master/render/schedule/block_set.h"
#include "mediator/frame/tile_film.h"

namespace tessera::master {

// The film of one view: that of each of its tiles. Film that does not match the frame (other rect, channels, samples
// beyond spp) is rejected. Single-threaded.
class FrameAssembler {
  public:
    FrameAssembler(std::vector<Rect> tiles, frame::ChannelSet channels, std::uint64_t spp);

    // Overlap: contains film of other units, see UnitLedger::admit().
    enum class Outcome { Merged, Duplicate, Conflict, Overlap, Misfit };
    struct Result {
        Outcome outcome = Outcome::Misfit;
        std::uint32_t tile = 0;
    };
    // It may replace blocks that `replaceable` covers.
    Result insert(frame::FilmTile block, const BlockSet& replaceable);

    std::uint32_t tile_count() const { return static_cast<std::uint32_t>(tiles_.size()); }
    // Film inserted from now on has these channels, too. Existing film stays, without them.
    void add_channels(frame::ChannelSet channels);

    frame::FilmTile merged_tile(std::uint32_t tile) const;  // without samples: zero counts
    frame::FilmTile whole() const;                          // all tiles in one; its block is meaningless
    // After add_channels(): the later samples alone, with all channels.
    std::optional<frame::FilmTile> later() const;
    // Of the samples that all pixels have.
    std::vector<frame::SampleBlock> roots(std::uint32_t tile) const { return films_[tile].roots(); }
    // All complete blocks, unmerged; not after add_channels().
    std::vector<frame::FilmTile> blocks() const;
    // The same of one tile, parts included; after add_channels() with the channels that all samples have.
    std::vector<frame::FilmTile> blocks(std::uint32_t tile) const {
        return (earlier_.empty() ? films_[tile] : all_blocks(tile)).blocks(frame::TileFilm::Parts::Included);
    }
    // See frame::TileFilm, in raster order of the whole film; 255 for pixels without samples.
    std::vector<std::uint8_t> doublings() const;
    // Of one tile; empty: it has no samples.
    std::vector<std::uint8_t> doublings(std::uint32_t tile) const {
        return films_[tile].empty() ? std::vector<std::uint8_t>() : films_[tile].doublings();
    }
    const std::vector<Rect>& tiles() const { return tiles_; }
    std::uint64_t byte_size() const;

  private:
    frame::TileFilm all_blocks(std::uint32_t tile) const;
    Rect bounds() const;
    template <class PasteTile>
    frame::FilmTile pasted(frame::ChannelSet channels, const PasteTile& paste_tile) const;

    std::vector<Rect> tiles_;
    frame::ChannelSet channels_;
    std::uint64_t spp_;
    std::vector<frame::TileFilm> films_;
    // After add_channels(): what there was before, and its channels.
    std::vector<frame::TileFilm> earlier_;
    frame::ChannelSet earlier_channels_;
    std::map<std::pair<std::int32_t, std::int32_t>, std::uint32_t> by_corner_;
};

}  // namespace tessera::master
