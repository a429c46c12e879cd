#include "mediator/frame/block_forest.h"

#include "mediator/frame/merge.h"

namespace tessera::frame {

BlockForest::Outcome BlockForest::insert(FilmTile block,
                                         const std::function<bool(const SampleBlock&)>& may_replace) {
    const SampleBlock range = block.block;
    const auto after = blocks_.upper_bound(range.first);
    if (after != blocks_.begin()) {
        const FilmTile& before = std::prev(after)->second;
        if (before.block == range) {
            return identical_bits(before, block) ? Outcome::Duplicate : Outcome::Conflict;
        }
        if (before.block.contains(range)) return Outcome::Duplicate;
    }
    Outcome outcome = Outcome::Merged;
    const auto first_inside = blocks_.lower_bound(range.first);
    for (auto inside = first_inside; inside != blocks_.end() && inside->first < range.end(); ++inside) {
        if (may_replace && !may_replace(inside->second.block)) return Outcome::Overlap;
    }
    auto inside = first_inside;
    while (inside != blocks_.end() && inside->first < range.end()) {
        inside = blocks_.erase(inside);
        outcome = Outcome::Replaced;
    }
    while (true) {
        const SampleBlock sibling = block.block.sibling();
        const auto other = blocks_.find(sibling.first);
        if (other == blocks_.end() || other->second.block != sibling) break;
        FilmTile earlier = std::move(other->second);
        blocks_.erase(other);
        if (block.block.first < earlier.block.first) std::swap(block, earlier);
        merge(earlier, block);
        block = std::move(earlier);
    }
    const std::uint64_t first = block.block.first;
    blocks_.emplace(first, std::move(block));
    return outcome;
}

bool BlockForest::covers(const SampleBlock& block) const {
    const auto after = blocks_.upper_bound(block.first);
    return after != blocks_.begin() && std::prev(after)->second.block.contains(block);
}

std::uint64_t BlockForest::sample_count() const {
    std::uint64_t count = 0;
    for (const auto& [first, block] : blocks_) count += block.block.count();
    return count;
}

std::vector<SampleBlock> BlockForest::roots() const {
    std::vector<SampleBlock> roots;
    for (const auto& [first, block] : blocks_) roots.push_back(block.block);
    return roots;
}

std::vector<SampleBlock> BlockForest::missing(std::uint64_t spp) const {
    std::vector<SampleBlock> missing;
    std::uint64_t next = 0;
    const auto add_until = [&](std::uint64_t end) {
        for (const SampleBlock& gap : aligned_blocks(next, end)) missing.push_back(gap);
    };
    for (const auto& [first, block] : blocks_) {
        if (first >= spp) break;
        add_until(first);
        next = block.block.end();
    }
    if (next < spp) add_until(spp);
    return missing;
}

FilmTile BlockForest::merged() const {
    if (blocks_.empty()) return {};
    auto root = blocks_.begin();
    FilmTile film = root->second;
    while (++root != blocks_.end()) merge(film, root->second);
    return film;
}

}  // namespace tessera::frame
