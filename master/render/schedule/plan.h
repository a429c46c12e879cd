#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "master/render/schedule/unit_trouble.h"
#include "mediator/base/clock.h"
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
    // How long nodes may hold film back, to merge it with that of further pieces of a claim.
    Duration hold_film = std::chrono::milliseconds(100);
    std::uint32_t max_crashes = 2;  // nodes that samples may cost before they are left out, see UnitTrouble
    bool is_adaptive = false;       // after the last round there may be a step, see Plan::begin_step()
};

// Which pixels of a tile get the samples of a round.
struct RoundMask {
    std::string bits;          // as view::WorkUnit::mask
    std::uint32_t pixels = 0;  // 0: none
};

struct Round {
    frame::SampleBlock block;
    std::shared_ptr<const std::vector<RoundMask>> masks;  // by tile; null: all pixels of all tiles
};

// The remaining work of one frame. Rounds double the number of samples (design 1.7), of all pixels or of those that need
// it; within a round tiles are ordered from the centre outwards. A node claims a block of samples of one tile and gets it piece by piece: it merges
// consecutive pieces before it sends their film, so a claim costs the network one film, however short its pieces are.
// The policy says how large claims are:
//   tiled        a tile's part of a round
//   cooperative  a part of that for each node, so that all nodes work on the same tile; but no less than a fifth of a unit
//   mixed        tiled as long as there are enough tiles for all workers, else cooperative
// What is left of a claim can be taken over by another node. Pure; the same calls give the same chunks.
class Plan {
  public:
    struct Chunk {
        std::uint32_t tile = 0;  // index into tiles()
        frame::SampleBlock block;
        bool again = false;                          // was dealt before and given back
        std::shared_ptr<const UnitTrouble> trouble;  // null: none
    };
    // The samples [next, end) of a claimed block have not been dealt.
    struct Claim {
        std::uint32_t tile = 0;
        std::uint64_t next = 0, end = 0;
        std::uint64_t left() const { return end - next; }
    };

    explicit Plan(const PlanSettings& settings);

    const std::vector<Rect>& tiles() const { return tiles_; }

    // A chunk that was given back and may go to the node, of at most max_count (>= 1) samples per pixel.
    std::optional<Chunk> next_returned(std::uint64_t max_count,
                                       const std::function<bool(const Chunk&)>& may_go);
    // The next piece of the node's claim, or of a new one; nothing if no samples are left to claim. `nodes` and
    // `workers`: that take part.
    std::optional<Chunk> next(NodeId node, std::uint64_t max_count, std::uint32_t nodes,
                              std::uint32_t workers);
    void give_back(const Chunk& chunk);

    const std::map<NodeId, Claim>& claims() const { return claims_; }
    std::uint64_t pixel_samples(const Claim& claim) const {
        return pixel_samples(claim.tile, claim.next, claim.left());
    }
    // The node gets no more pieces of its claim: others will.
    void release_claim(NodeId node);
    const std::deque<Chunk>& returned() const { return returned_; }
    // Gives the upper half of what is left of the victim's claim, or all if it is a single sample, to a node without
    // a claim.
    void take_over(NodeId node, NodeId victim);

    // No more samples of the tile are dealt.
    void close_tile(std::uint32_t tile);
    bool is_closed(std::uint32_t tile) const { return closed_[tile]; }

    // An adaptive plan: goes on with these rounds, whose blocks are disjoint. Only when paused.
    void begin_step(std::vector<Round> rounds);
    void finish_steps() { settings_.is_adaptive = false; }
    const std::vector<Round>& rounds() const { return rounds_; }  // all, or those of the current step
    // The mask of a piece of a current round; null: all pixels.
    const RoundMask* mask(std::uint32_t tile, std::uint64_t sample) const;

    // Rounds that begin with this sample or a later one wait until the limit is raised.
    void hold_at(std::uint64_t sample) { hold_ = sample; }

    bool exhausted() const {
        return !settings_.is_adaptive && returned_.empty() && claims_.empty() && round_ == rounds_.size();
    }
    bool paused() const {
        return returned_.empty() && claims_.empty() && (round_ == rounds_.size() || is_held());
    }
    std::uint64_t remaining_samples() const { return remaining_samples_; }  // pixel samples not dealt

    // For deadlines: whether the next claim is the first of its round, the size of that round, and splitting it
    // into eighths.
    bool at_round_start() const { return cursor_ == 0 && offset_ == 0 && round_ != rounds_.size(); }
    std::uint64_t round_samples() const;
    void deal_round_in_eighths();

  private:
    bool is_held() const { return rounds_[round_].block.first >= hold_; }
    // For tiles of the usual size with all pixels -> for these.
    std::uint64_t scaled(std::uint64_t max_count, std::uint32_t tile, std::uint64_t sample) const;
    std::uint64_t claim_samples(const frame::SampleBlock& round, std::uint64_t max_count, std::uint32_t nodes,
                                std::uint32_t workers) const;
    std::optional<Claim> new_claim(std::uint64_t max_count, std::uint32_t nodes, std::uint32_t workers);
    void advance(std::uint64_t count);
    void next_tile();
    void skip_closed();
    // Of so many samples from `first` on.
    std::uint64_t pixel_samples(std::uint32_t tile, std::uint64_t first, std::uint64_t count) const;

    PlanSettings settings_;
    std::vector<Rect> tiles_;
    std::vector<bool> closed_;          // by tile
    std::vector<std::uint32_t> order_;  // tile indices, centre first
    std::vector<Round> rounds_;
    std::size_t round_ = 0, cursor_ = 0;
    std::uint64_t offset_ = 0;        // samples of rounds_[round_] already claimed for order_[cursor_]
    std::map<NodeId, Claim> claims_;  // none is empty
    std::deque<Chunk> returned_;
    std::uint64_t remaining_samples_ = 0;
    std::uint64_t hold_ = ~std::uint64_t{0};
};

// [0, spp) in rounds: 2^first_level samples, then as many again each time, then the rest as aligned blocks.
std::vector<frame::SampleBlock> doubling_rounds(std::uint64_t spp, std::uint32_t first_level);

// The window cut into squares on a grid from its top left corner, in raster order.
std::vector<Rect> tile_grid(const Rect& window, std::uint32_t tile);

}  // namespace tessera::master
