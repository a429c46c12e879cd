#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "master/render/schedule/block_set.h"
#include "mediator/frame/block_forest.h"

namespace tessera::master {

// The film of one view: a block forest per tile. Film that does not match the frame (other rect, channels, samples
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
    std::vector<frame::SampleBlock> roots(std::uint32_t tile) const { return forests_[tile].roots(); }
    std::vector<frame::FilmTile> blocks() const;  // all blocks, unmerged; not after add_channels()
    std::uint64_t byte_size() const;

  private:
    frame::BlockForest all_blocks(std::uint32_t tile) const;
    template <class PasteTile>
    frame::FilmTile pasted(frame::ChannelSet channels, const PasteTile& paste_tile) const;

    std::vector<Rect> tiles_;
    frame::ChannelSet channels_;
    std::uint64_t spp_;
    std::vector<frame::BlockForest> forests_;
    // After add_channels(): what there was before, and its channels.
    std::vector<frame::BlockForest> earlier_;
    frame::ChannelSet earlier_channels_;
    std::map<std::pair<std::int32_t, std::int32_t>, std::uint32_t> by_corner_;
};

}  // namespace tessera::master
