#include "master/render/schedule/block_set.h"

namespace tessera::master {

using frame::SampleBlock;

void BlockSet::insert(const SampleBlock& block) {
    if (covers(block)) return;
    // Blocks inside the new block start inside it, since blocks are nested or disjoint.
    auto inside = blocks_.lower_bound(SampleBlock{block.first, 0});
    while (inside != blocks_.end() && inside->first < block.end()) {
        sample_count_ -= inside->count();
        inside = blocks_.erase(inside);
    }
    sample_count_ += block.count();
    SampleBlock joined = block;
    for (auto sibling = blocks_.find(joined.sibling()); sibling != blocks_.end();
         sibling = blocks_.find(joined.sibling())) {
        blocks_.erase(sibling);
        joined = joined.parent();
    }
    blocks_.insert(joined);
}

bool BlockSet::covers(const SampleBlock& block) const {
    auto next = blocks_.upper_bound(SampleBlock{block.first, 64});
    return next != blocks_.begin() && std::prev(next)->contains(block);
}

std::vector<SampleBlock> BlockSet::missing_in(const SampleBlock& block) const {
    if (covers(block)) return {};
    std::vector<SampleBlock> missing;
    std::uint64_t next = block.first;
    const auto add_until = [&](std::uint64_t end) {
        for (const SampleBlock& gap : frame::aligned_blocks(next, end)) missing.push_back(gap);
    };
    for (auto inside = blocks_.lower_bound(SampleBlock{block.first, 0});
         inside != blocks_.end() && inside->first < block.end(); ++inside) {
        add_until(inside->first);
        next = inside->end();
    }
    add_until(block.end());
    return missing;
}

}  // namespace tessera::master
