#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/wire/journal_records.h"

namespace tessera::wire {

// Decoding takes anything: what is malformed or contradicts itself is an Error{InvalidInput}; never throws
// for content.
std::vector<std::byte> encode(const JournalRecord& record);
Expected<JournalRecord> decode_journal_record(std::span<const std::byte> bytes);

std::vector<std::byte> encode(const KeptJob& job);
Expected<KeptJob> decode_kept_job(std::span<const std::byte> bytes);

// Everything but the blocks of film: those are encoded one by one, `views[i]` has the next
// `block_counts[i]`.
std::vector<std::byte> encode(const CheckpointState& state);
Expected<CheckpointState> decode_checkpoint(std::span<const std::byte> bytes);

// A block of film as on the bulk link: raw planes.
std::vector<std::byte> encode_film(const frame::FilmTile& film);
Expected<frame::FilmTile> decode_film(std::span<const std::byte> bytes);

}  // namespace tessera::wire
