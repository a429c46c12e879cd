#pragma once

#include <set>
#include <vector>

#include "mediator/frame/sample_block.h"

namespace tessera::master {

// Which samples of one tile have been merged: disjoint aligned blocks, siblings joined. The scheduler's record; the
// film itself is in the film store.
class BlockSet {
  public:
    void insert(const frame::SampleBlock& block);
    bool covers(const frame::SampleBlock& block) const;
    std::vector<frame::SampleBlock> missing_in(const frame::SampleBlock& block) const;  // ascending
    std::uint64_t sample_count() const { return sample_count_; }
    const std::set<frame::SampleBlock>& blocks() const { return blocks_; }  // ascending

  private:
    std::set<frame::SampleBlock> blocks_;  // ordered by first sample
    std::uint64_t sample_count_ = 0;
};

}  // namespace tessera::master
