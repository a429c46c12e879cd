#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mediator/frame/film_state.h"
#include "mediator/picture/exr_writer.h"

namespace tessera::picture {

// The K-th block of each pixel of a film: its samples [first, first + size); size 0: the pixel has fewer blocks.
struct PixelBlocks {
    frame::FilmTile film;  // of the whole window
    std::vector<std::uint32_t> first, size;
};

// The raw planes of a channel, in the order of the film, as layer `name` with components p0, p1, ...
Layer plane_layer(const std::string& name, const frame::FilmTile& film, const frame::ChannelInfo& entry);

// The blocks of a film as layers blocks.K.*: first, size, count and the planes of all channels. A film whose pixels have one
// block each needs no planes, since they are its own. Layer `wanted` is 1 where the current step has samples left.
std::vector<Layer> state_layers(const frame::FilmTile& film, const frame::FilmState& state);

// The state from the blocks, for tiles of this edge. Throws Error{InvalidInput} if no film has such blocks.
frame::FilmState state_of(const std::vector<PixelBlocks>& blocks, const std::vector<std::uint32_t>& wanted,
                          std::uint32_t steps, std::uint32_t tile_edge);

}  // namespace tessera::picture
