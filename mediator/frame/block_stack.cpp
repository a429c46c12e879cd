#include "mediator/frame/block_stack.h"

#include <utility>

#include "mediator/frame/merge.h"

namespace tessera::frame {

void BlockStack::push(FilmTile block) {
    while (!blocks_.empty() && blocks_.back().block == block.block.sibling()) {
        FilmTile earlier = std::move(blocks_.back());
        blocks_.pop_back();
        merge(earlier, block);
        std::swap(earlier, block);
        spare_.push_back(std::move(earlier));
    }
    blocks_.push_back(std::move(block));
}

std::vector<FilmTile> BlockStack::take() {
    return std::exchange(blocks_, {});
}

FilmTile BlockStack::recycled(Rect rect, SampleBlock block, ChannelSet channels, const PixelSet& pixels) {
    if (spare_.empty()) return FilmTile(rect, block, channels, pixels);
    FilmTile tile = std::move(spare_.back());
    spare_.pop_back();
    if (tile.rect != rect || tile.channels != channels || tile.pixels != pixels)
        return FilmTile(rect, block, channels, pixels);
    tile.reset(block);
    return tile;
}

}  // namespace tessera::frame
