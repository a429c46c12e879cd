#include "master/render/schedule/plan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace tessera::master {

using frame::SampleBlock;

std::vector<SampleBlock> doubling_rounds(std::uint64_t spp, std::uint32_t first_level) {
    std::vector<SampleBlock> rounds;
    for (const SampleBlock& block : frame::aligned_blocks(0, spp)) {
        if (block.first != 0) {
            rounds.push_back(block);
            continue;
        }
        const std::uint32_t first = std::min(first_level, block.level);
        rounds.push_back({0, first});
        for (std::uint32_t level = first; level < block.level; ++level) {
            rounds.push_back({std::uint64_t{1} << level, level});
        }
    }
    return rounds;
}

std::vector<Rect> tile_grid(const Rect& window, std::uint32_t tile) {
    std::vector<Rect> tiles;
    const auto edge = static_cast<std::int32_t>(tile);
    for (std::int32_t y = window.y; y < window.bottom(); y += edge) {
        for (std::int32_t x = window.x; x < window.right(); x += edge) {
            tiles.push_back(intersection({x, y, edge, edge}, window));
        }
    }
    return tiles;
}

namespace {

// The largest aligned block at `first` of at most `limit` samples that ends at `end` or earlier.
SampleBlock first_piece(std::uint64_t first, std::uint64_t end, std::uint64_t limit) {
    SampleBlock block{first, 0};
    while (block.parent().first == first && block.parent().count() <= std::min(limit, end - first))
        block = block.parent();
    return block;
}

}  // namespace

Plan::Plan(const PlanSettings& settings)
    : settings_(settings),
      tiles_(tile_grid(settings.window, settings.tile)),
      closed_(tiles_.size(), false),
      order_(tiles_.size()),
      remaining_samples_(settings.window.pixel_count() * settings.spp) {
    for (const SampleBlock& block : doubling_rounds(settings.spp, settings.first_level))
        rounds_.push_back({block, nullptr});
    std::iota(order_.begin(), order_.end(), 0u);
    const double middle_x = settings.window.x + 0.5 * settings.window.width;
    const double middle_y = settings.window.y + 0.5 * settings.window.height;
    const auto distance = [&](std::uint32_t index) {
        const Rect& tile = tiles_[index];
        return std::hypot(tile.x + 0.5 * tile.width - middle_x, tile.y + 0.5 * tile.height - middle_y);
    };
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return distance(a) < distance(b); });
}

void Plan::begin_step(std::vector<Round> rounds) {
    rounds_ = std::move(rounds);
    round_ = cursor_ = 0;
    offset_ = 0;
    remaining_samples_ = 0;
    for (const Round& round : rounds_) {
        for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) {
            if (!closed_[tile])
                remaining_samples_ += pixel_samples(tile, round.block.first, round.block.count());
        }
    }
    skip_closed();
}

const RoundMask* Plan::mask(std::uint32_t tile, std::uint64_t sample) const {
    const auto round = std::ranges::find_if(
        rounds_, [&](const Round& one) { return one.block.first <= sample && sample < one.block.end(); });
    return round != rounds_.end() && round->masks ? &(*round->masks)[tile] : nullptr;
}

std::uint64_t Plan::pixel_samples(std::uint32_t tile, std::uint64_t first, std::uint64_t count) const {
    const RoundMask* some = mask(tile, first);
    return count * (some != nullptr ? some->pixels : tiles_[tile].pixel_count());
}

std::uint64_t Plan::scaled(std::uint64_t max_count, std::uint32_t tile, std::uint64_t sample) const {
    const RoundMask* some = mask(tile, sample);
    const std::uint64_t least = std::max<std::uint64_t>(max_count, 1);
    return some != nullptr ? std::max<std::uint64_t>(1, least * tiles_.front().pixel_count() / some->pixels)
                           : least;
}

// `max_count`: of a unit. Shorter units than a fifth of that would be rendered before the next ones have crossed the
// network, however many a node has in hand.
std::uint64_t Plan::claim_samples(const SampleBlock& round, std::uint64_t max_count, std::uint32_t nodes,
                                  std::uint32_t workers) const {
    constexpr std::uint64_t ShortestPart = 5;
    std::uint64_t parts = 1, least = 1;
    if (settings_.policy == session::Policy::Cooperative) {
        parts = std::bit_ceil(std::max(nodes, 2u));
        least = std::clamp<std::uint64_t>(max_count / ShortestPart, 1, round.count());
    } else if (settings_.policy == session::Policy::Mixed && tiles_.size() < workers) {
        const auto tiles = static_cast<std::uint32_t>(tiles_.size());
        parts = std::bit_ceil((workers + tiles - 1) / tiles);
    }
    return std::max(least, round.count() / parts);
}

std::optional<Plan::Claim> Plan::new_claim(std::uint64_t max_count, std::uint32_t nodes,
                                           std::uint32_t workers) {
    if (round_ == rounds_.size() || is_held()) return std::nullopt;
    const SampleBlock round = rounds_[round_].block;
    const std::uint32_t tile = order_[cursor_];
    const std::uint64_t first = round.first + offset_;
    const std::uint64_t unit = scaled(max_count, tile, first);
    const SampleBlock block = first_piece(first, round.end(), claim_samples(round, unit, nodes, workers));
    advance(block.count());
    return Claim{tile, block.first, block.end()};
}

std::optional<Plan::Chunk> Plan::next_returned(std::uint64_t max_count,
                                               const std::function<bool(const Chunk&)>& may_go) {
    const auto found = std::find_if(returned_.begin(), returned_.end(), may_go);
    if (found == returned_.end()) return std::nullopt;
    Chunk chunk = *found;
    returned_.erase(found);
    while (chunk.block.count() > scaled(max_count, chunk.tile, chunk.block.first)) {
        chunk.block.level -= 1;
        Chunk rest = chunk;
        rest.block = chunk.block.sibling();
        returned_.push_front(std::move(rest));
    }
    remaining_samples_ -= pixel_samples(chunk.tile, chunk.block.first, chunk.block.count());
    return chunk;
}

std::optional<Plan::Chunk> Plan::next(NodeId node, std::uint64_t max_count, std::uint32_t nodes,
                                      std::uint32_t workers) {
    auto claimed = claims_.find(node);
    if (claimed == claims_.end()) {
        const std::optional<Claim> claim = new_claim(max_count, nodes, workers);
        if (!claim) return std::nullopt;
        claimed = claims_.emplace(node, *claim).first;
    }
    Claim& claim = claimed->second;
    Chunk chunk{.tile = claim.tile,
                .block = first_piece(claim.next, claim.end, scaled(max_count, claim.tile, claim.next)),
                .trouble = nullptr};
    claim.next = chunk.block.end();
    if (claim.left() == 0) claims_.erase(claimed);
    remaining_samples_ -= pixel_samples(chunk.tile, chunk.block.first, chunk.block.count());
    return chunk;
}

void Plan::give_back(const Chunk& chunk) {
    if (closed_[chunk.tile]) return;
    returned_.push_back(chunk);
    returned_.back().again = true;
    remaining_samples_ += pixel_samples(chunk.tile, chunk.block.first, chunk.block.count());
}

void Plan::release_claim(NodeId node) {
    const auto claim = claims_.extract(node);
    if (claim.empty()) return;
    const Claim& left = claim.mapped();
    for (const SampleBlock& block : frame::aligned_blocks(left.next, left.end))
        returned_.push_back({.tile = left.tile, .block = block, .trouble = nullptr});
}

void Plan::take_over(NodeId node, NodeId victim) {
    const auto from = claims_.find(victim);
    if (from == claims_.end() || claims_.contains(node)) return;
    Claim& claim = from->second;
    const std::vector<SampleBlock> blocks = frame::aligned_blocks(claim.next, claim.end);
    // The blocks ascend, and so do their sizes: the last one is at least half of all.
    SampleBlock taken = blocks.back();
    if (blocks.size() == 1 && taken.level > 0) {
        --taken.level;
        taken = taken.sibling();
    }
    const Claim stolen{claim.tile, taken.first, taken.end()};
    claim.end = taken.first;
    if (claim.left() == 0) claims_.erase(from);
    claims_.emplace(node, stolen);
}

void Plan::close_tile(std::uint32_t tile) {
    if (closed_[tile]) return;
    closed_[tile] = true;
    std::erase_if(returned_, [&](const Chunk& chunk) {
        if (chunk.tile != tile) return false;
        remaining_samples_ -= pixel_samples(tile, chunk.block.first, chunk.block.count());
        return true;
    });
    std::erase_if(claims_, [&](const auto& entry) {
        if (entry.second.tile != tile) return false;
        remaining_samples_ -= pixel_samples(tile, entry.second.next, entry.second.left());
        return true;
    });
    // What has not been claimed yet.
    const auto at = static_cast<std::size_t>(std::find(order_.begin(), order_.end(), tile) - order_.begin());
    for (std::size_t round = round_; round < rounds_.size(); ++round) {
        const SampleBlock& block = rounds_[round].block;
        std::uint64_t left = block.count();
        if (round == round_ && at < cursor_) continue;
        if (round == round_ && at == cursor_) left -= offset_;
        remaining_samples_ -= pixel_samples(tile, block.first, left);
    }
    skip_closed();
}

void Plan::advance(std::uint64_t count) {
    offset_ += count;
    if (offset_ == rounds_[round_].block.count()) next_tile();
    skip_closed();
}

void Plan::next_tile() {
    offset_ = 0;
    if (++cursor_ < order_.size()) return;
    cursor_ = 0;
    ++round_;
}

void Plan::skip_closed() {
    while (round_ != rounds_.size()) {
        const std::uint32_t tile = order_[cursor_];
        const auto& masks = rounds_[round_].masks;
        if (!closed_[tile] && (!masks || (*masks)[tile].pixels > 0)) return;
        next_tile();
    }
}

std::uint64_t Plan::round_samples() const {
    if (round_ == rounds_.size()) return 0;
    const Round& round = rounds_[round_];
    if (!round.masks) return round.block.count() * settings_.window.pixel_count();
    std::uint64_t pixels = 0;
    for (const RoundMask& mask : *round.masks) pixels += mask.pixels;
    return round.block.count() * pixels;
}

void Plan::deal_round_in_eighths() {
    const Round round = rounds_[round_];
    const std::uint32_t level = round.block.level - std::min(round.block.level, 3u);
    std::vector<Round> eighths;
    for (std::uint64_t first = round.block.first; first < round.block.end();
         first += std::uint64_t{1} << level) {
        eighths.push_back({{first, level}, round.masks});
    }
    const auto at = rounds_.erase(rounds_.begin() + static_cast<std::ptrdiff_t>(round_));
    rounds_.insert(at, eighths.begin(), eighths.end());
}

}  // namespace tessera::master
