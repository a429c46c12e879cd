#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "mediator/frame/block_forest.h"

namespace tessera::frame {

// The film of one tile where some pixels may have more samples than others.
//
// At first all pixels have the samples of a block forest. Once these are one block, [0, 2^k), the samples of some pixels can
// be doubled by the block [2^k, 2^(k + 1)), of some of these by the next one, and so on. Such a block arrives in parts: for
// disjoint sets of pixels, each as smaller blocks in any order. A pixel's bits depend on the samples that it has alone, not on
// those of others, on parts or order.
class TileFilm {
  public:
    using Outcome = BlockForest::Outcome;

    // As BlockForest::insert(). Duplicate: the pixels have the samples. Overlap: so do some of them, or they get them as
    // another part.
    Outcome insert(FilmTile block, const std::function<bool(const SampleBlock&)>& may_replace = {});

    bool empty() const { return doublings_.empty() && all_.blocks().empty(); }
    // With the parts that have arrived. An empty film gives a tile without pixels.
    FilmTile merged() const;
    const FilmTile* only_block() const;  // of all samples there are; null: there are several, or none
    // Of the samples that all pixels have, until some have more.
    std::vector<SampleBlock> roots() const { return all_.roots(); }
    // How often the number of samples of each pixel was doubled: it has 2^that, rejected ones included, and parts of more.
    // Only once the first samples are one block.
    std::vector<std::uint8_t> doublings() const;

    enum class Parts { Included, LeftOut };
    // Which give the same film if they are inserted in this order.
    std::vector<FilmTile> blocks(Parts parts) const;
    std::size_t byte_size() const;

  private:
    struct Part {
        SampleBlock range;  // to which its blocks belong, [2^k, 2^(k + 1))
        PixelSet pixels;
        BlockForest blocks;
    };
    static constexpr std::uint8_t None = 255;  // a pixel without samples

    bool begin_doubling(std::uint8_t none_or_level);
    bool all_have(const PixelSet& pixels, std::uint8_t doublings) const;
    Outcome insert_first(FilmTile block);
    Outcome insert_part(FilmTile block, const std::function<bool(const SampleBlock&)>& may_replace);
    void take_complete_parts();
    void add(FilmTile& film, const Part& part) const;

    BlockForest all_;
    std::vector<std::uint8_t> doublings_;  // empty: all pixels have the samples of all_
    FilmTile film_;                        // else: of 2^doublings_ samples
    std::vector<Part> parts_;
};

}  // namespace tessera::frame
