#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "master/render/frame_assembler.h"
#include "master/render/schedule/plan.h"
#include "mediator/frame/film_state.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

// The current step of an adaptive picture, for a master restart. The next decision needs the film as it is after the step,
// so that the picture gets the bits of one that was not interrupted.
std::vector<wire::SavedPart> saved_step(std::span<const Round> rounds, std::span<const Rect> tiles);

// What film lacks of it: by number of samples, ascending. Parts that do not fit the film are left out.
std::vector<Round> remaining_rounds(std::span<const wire::SavedPart> step, const FrameAssembler& film);

// The same of the step's rounds, of one tile.
std::vector<frame::WantedSamples> wanted_samples(std::span<const Round> step, const FrameAssembler& film,
                                                 std::uint32_t tile);
// As a client has it.
std::vector<wire::SavedPart> saved_step(std::span<const frame::WantedSamples> wanted);

}  // namespace tessera::master
