#pragma once

#include "mediator/backend/backend.h"
#include "mediator/frame/block_stack.h"

namespace tessera::backend {

// Renders the samples of a unit in order and merges them. fill(tile, rays) adds one sample to every pixel of the
// tile and counts its rays; it returns false when it was stopped, and this sample is discarded.
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
