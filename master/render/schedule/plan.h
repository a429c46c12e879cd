#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "mediator/base/rect.h"
#include "mediator/frame/sample_block.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

struct PlanSettings {
    Rect window;
    std::uint32_t tile = 32;  // edge in pixels
    std::uint64_t spp = 64;
    session::Policy policy = session::Policy::Mixed;
    std::uint32_t first_level = 0;  // the first round has 2^first_level samples
};

// The remaining work of one frame. Rounds double the number of samples (design 1.7); within a round tiles are
// ordered from the centre outwards. The policy says how a tile's part of a round is split:
//   tiled        one unit
//   cooperative  `splits` equal sample ranges, so that all nodes work on the same tile
//   mixed        tiled while a round has at most 4 samples (first pixels), then cooperative (convergence)
// Pure; the same calls give the same chunks.
class Plan {
  public:
    struct Chunk {
        std::uint32_t tile = 0;  // index into tiles()
        frame::SampleBlock block;
        bool again = false;  // was dealt before and given back
    };

    explicit Plan(const PlanSettings& settings);

    const std::vector<Rect>& tiles() const { return tiles_; }

    // The next chunk of at most max_count (>= 1) samples per pixel. Chunks given back go first.
    std::optional<Chunk> next(std::uint64_t max_count, std::uint32_t splits);
    void give_back(const Chunk& chunk);

    // Rounds that begin with this sample or a later one wait until the limit is raised.
    void hold_at(std::uint64_t sample) { hold_ = sample; }

    bool exhausted() const { return returned_.empty() && round_ == rounds_.size(); }
    bool paused() const { return returned_.empty() && (round_ == rounds_.size() || is_held()); }
    std::uint64_t remaining_samples() const { return remaining_samples_; }  // pixel samples not dealt

    // For deadlines: whether the next chunk is the first of its round, the size of that round, and splitting it
    // into eighths.
    bool at_round_start() const { return returned_.empty() && cursor_ == 0 && offset_ == 0 && !exhausted(); }
    std::uint64_t round_samples() const;
    void deal_round_in_eighths();

  private:
    bool is_held() const { return rounds_[round_].first >= hold_; }
    std::uint64_t samples_per_unit(const frame::SampleBlock& round, std::uint32_t splits) const;
    void advance(std::uint64_t count);

    PlanSettings settings_;
    std::vector<Rect> tiles_;
    std::vector<std::uint32_t> order_;  // tile indices, centre first
    std::vector<frame::SampleBlock> rounds_;
    std::size_t round_ = 0, cursor_ = 0;
    std::uint64_t offset_ = 0;  // samples of rounds_[round_] already dealt for order_[cursor_]
    std::deque<Chunk> returned_;
    std::uint64_t remaining_samples_ = 0;
    std::uint64_t hold_ = ~std::uint64_t{0};
};

// [0, spp) in rounds: 2^first_level samples, then as many again each time, then the rest as aligned blocks.
std::vector<frame::SampleBlock> doubling_rounds(std::uint64_t spp, std::uint32_t first_level);

// The window cut into squares on a grid from its top left corner, in raster order.
std::vector<Rect> tile_grid(const Rect& window, std::uint32_t tile);

}  // namespace tessera::master
