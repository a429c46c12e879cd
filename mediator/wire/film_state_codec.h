#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/frame/film_state.h"

namespace tessera::wire {

// The content of a blob from which a view goes on (EarlierFilm): messages FilmBlock, each after its size. Decoding accepts
// arbitrary bytes, as decode_bulk().
std::vector<std::byte> encode(const frame::FilmState& film);
Expected<frame::FilmState> decode_film_state(std::span<const std::byte> bytes);

// The samples as a message: without any, in one channel of the film.
frame::FilmTile without_samples(const frame::WantedSamples& wanted, frame::ChannelSet channels);

}  // namespace tessera::wire
