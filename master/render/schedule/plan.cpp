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
      rounds_(doubling_rounds(settings.spp, settings.first_level)),
      remaining_samples_(settings.window.pixel_count() * settings.spp) {
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
    const SampleBlock round = rounds_[round_];
    const std::uint32_t tile = order_[cursor_];
    const std::uint64_t first = round.first + offset_;
    const SampleBlock block =
        first_piece(first, round.end(), claim_samples(round, max_count, nodes, workers));
    advance(block.count());
    return Claim{tile, block.first, block.end()};
}

std::optional<Plan::Chunk> Plan::next_returned(std::uint64_t max_count,
                                               const std::function<bool(const Chunk&)>& may_go) {
    const auto found = std::find_if(returned_.begin(), returned_.end(), may_go);
    if (found == returned_.end()) return std::nullopt;
    Chunk chunk = *found;
    returned_.erase(found);
    while (chunk.block.count() > std::max<std::uint64_t>(max_count, 1)) {
        chunk.block.level -= 1;
        Chunk rest = chunk;
        rest.block = chunk.block.sibling();
        returned_.push_front(std::move(rest));
    }
    remaining_samples_ -= pixel_samples(chunk.tile, chunk.block.count());
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
                .block = first_piece(claim.next, claim.end, std::max<std::uint64_t>(max_count, 1)),
                .trouble = nullptr};
    claim.next = chunk.block.end();
    if (claim.left() == 0) claims_.erase(claimed);
    remaining_samples_ -= pixel_samples(chunk.tile, chunk.block.count());
    return chunk;
}

void Plan::give_back(const Chunk& chunk) {
    if (closed_[chunk.tile]) return;
    returned_.push_back(chunk);
    returned_.back().again = true;
    remaining_samples_ += pixel_samples(chunk.tile, chunk.block.count());
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
        remaining_samples_ -= pixel_samples(tile, chunk.block.count());
        return true;
    });
    std::erase_if(claims_, [&](const auto& entry) {
        if (entry.second.tile != tile) return false;
        remaining_samples_ -= pixel_samples(tile, entry.second.left());
        return true;
    });
    // What has not been claimed yet.
    const auto at = static_cast<std::size_t>(std::find(order_.begin(), order_.end(), tile) - order_.begin());
    for (std::size_t round = round_; round < rounds_.size(); ++round) {
        std::uint64_t left = rounds_[round].count();
        if (round == round_ && at < cursor_) continue;
        if (round == round_ && at == cursor_) left -= offset_;
        remaining_samples_ -= pixel_samples(tile, left);
    }
    skip_closed();
}

void Plan::advance(std::uint64_t count) {
    offset_ += count;
    if (offset_ == rounds_[round_].count()) next_tile();
    skip_closed();
}

void Plan::next_tile() {
    offset_ = 0;
    if (++cursor_ < order_.size()) return;
    cursor_ = 0;
    ++round_;
}

void Plan::skip_closed() {
    while (round_ != rounds_.size() && closed_[order_[cursor_]]) next_tile();
}

std::uint64_t Plan::round_samples() const {
    return round_ == rounds_.size() ? 0 : rounds_[round_].count() * settings_.window.pixel_count();
}

void Plan::deal_round_in_eighths() {
    const SampleBlock round = rounds_[round_];
    const std::uint32_t level = round.level - std::min(round.level, 3u);
    std::vector<SampleBlock> eighths;
    for (std::uint64_t first = round.first; first < round.end(); first += std::uint64_t{1} << level) {
        eighths.push_back({first, level});
    }
    const auto at = rounds_.erase(rounds_.begin() + static_cast<std::ptrdiff_t>(round_));
    rounds_.insert(at, eighths.begin(), eighths.end());
}

}  // namespace tessera::master
