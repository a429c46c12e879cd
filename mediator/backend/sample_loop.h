#pragma once

#include "mediator/backend/backend.h"
#include "mediator/frame/block_stack.h"

namespace tessera::backend {

// visit(i, x, y) for the i-th pixel of the tile's film. False: stopped before the end.
template <class Visit>
bool for_each_pixel(const frame::FilmTile& tile, const std::stop_token& stop, const Visit& visit) {
    const Rect& rect = tile.rect;
    if (tile.pixels.is_all()) {
        std::size_t pixel = 0;
        for (std::int32_t y = rect.y; y < rect.bottom(); ++y) {
            if (stop.stop_requested()) return false;
            for (std::int32_t x = rect.x; x < rect.right(); ++x, ++pixel) visit(pixel, x, y);
        }
        return true;
    }
    std::size_t pixel = 0;
    std::int32_t last_row = -1;
    for (const std::uint32_t index : tile.pixels.indices()) {
        const auto at = static_cast<std::int32_t>(index), row = at / rect.width;
        if (row != last_row && stop.stop_requested()) return false;
        last_row = row;
        visit(pixel++, rect.x + at % rect.width, rect.y + row);
    }
    return true;
}

// Renders the samples of a unit in order and merges them. fill(tile, rays) adds one sample to every pixel of the
// tile and counts its rays; it returns false when it was stopped, and this sample is discarded.
template <class Fill>
RenderResult render_samples(const view::WorkUnit& unit, frame::ChannelSet channels, const Fill& fill) {
    frame::BlockStack finished;
    const frame::PixelSet pixels = unit.pixels().value();
    RenderResult result{.status = RenderStatus::Done};
    for (std::uint64_t sample = unit.block.first; sample < unit.block.end(); ++sample) {
        frame::FilmTile tile = finished.recycled(unit.tile, {sample, 0}, channels, pixels);
        if (!fill(tile, result.rays)) {
            result.status = RenderStatus::Stopped;
            break;
        }
        finished.push(std::move(tile));
    }
    result.blocks = finished.take();
    return result;
}

}  // namespace tessera::backend
