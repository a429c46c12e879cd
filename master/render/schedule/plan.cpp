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

Plan::Plan(const PlanSettings& settings)
    : settings_(settings),
      tiles_(tile_grid(settings.window, settings.tile)),
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

std::uint64_t Plan::samples_per_unit(const SampleBlock& round, std::uint32_t splits) const {
    const bool split = settings_.policy == session::Policy::Cooperative ||
                       (settings_.policy == session::Policy::Mixed && round.count() > 4);
    if (!split) return round.count();
    return std::max<std::uint64_t>(1, round.count() / std::bit_ceil(std::max(splits, 2u)));
}

std::optional<Plan::Chunk> Plan::next(std::uint64_t max_count, std::uint32_t splits) {
    if (!returned_.empty()) {
        Chunk chunk = returned_.front();
        returned_.pop_front();
        while (chunk.block.count() > std::max<std::uint64_t>(max_count, 1)) {
            chunk.block.level -= 1;
            returned_.push_front({chunk.tile, chunk.block.sibling(), true});
        }
        remaining_samples_ -= chunk.block.count() * tiles_[chunk.tile].pixel_count();
        return chunk;
    }
    if (round_ == rounds_.size() || is_held()) return std::nullopt;
    const SampleBlock& round = rounds_[round_];
    const std::uint64_t limit =
        std::min(std::max<std::uint64_t>(max_count, 1), samples_per_unit(round, splits));
    const std::uint64_t left = round.count() - offset_;
    SampleBlock block{round.first + offset_, 0};
    while (block.parent().first == block.first && block.parent().count() <= std::min(limit, left)) {
        block = block.parent();
    }
    const Chunk chunk{order_[cursor_], block};
    advance(block.count());
    remaining_samples_ -= block.count() * tiles_[chunk.tile].pixel_count();
    return chunk;
}

void Plan::advance(std::uint64_t count) {
    offset_ += count;
    if (offset_ < rounds_[round_].count()) return;
    offset_ = 0;
    if (++cursor_ < order_.size()) return;
    cursor_ = 0;
    ++round_;
}

void Plan::give_back(const Chunk& chunk) {
    returned_.push_back({chunk.tile, chunk.block, true});
    remaining_samples_ += chunk.block.count() * tiles_[chunk.tile].pixel_count();
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
    const auto place = rounds_.erase(rounds_.begin() + static_cast<std::ptrdiff_t>(round_));
    rounds_.insert(place, eighths.begin(), eighths.end());
}

}  // namespace tessera::master
