#pragma once

#include "mediator/backend/backend.h"
#include "mediator/frame/block_stack.h"

namespace tessera::backend {

// The samples of a unit one after the other, merged as they come. fill(tile, rays) puts one sample into every
// pixel of the tile and counts its rays; false: stopped on the way, and this sample is dropped.
template <class Fill>
RenderResult render_samples(const view::WorkUnit& unit, frame::ChannelSet channels, const Fill& fill) {
    frame::BlockStack finished;
    RenderResult result{.status = RenderStatus::Done};
    for (std::uint64_t sample = unit.block.first; sample < unit.block.end(); ++sample) {
        frame::FilmTile tile = finished.recycled(unit.tile, {sample, 0}, channels);
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
