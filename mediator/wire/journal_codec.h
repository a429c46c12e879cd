#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/wire/journal_records.h"

namespace tessera::wire {

// Decoding accepts arbitrary bytes: malformed or inconsistent data is an Error{InvalidInput}; content never causes an
// exception.
std::vector<std::byte> encode(const JournalRecord& record);
Expected<JournalRecord> decode_journal_record(std::span<const std::byte> bytes);

std::vector<std::byte> encode(const StoredJob& job);
Expected<StoredJob> decode_stored_job(std::span<const std::byte> bytes);

// Everything but the blocks of film: those are encoded one by one, `views[i]` has the next
// `block_counts[i]`.
std::vector<std::byte> encode(const CheckpointState& state);
Expected<CheckpointState> decode_checkpoint(std::span<const std::byte> bytes);

// A block of film as on the bulk link: raw planes.
std::vector<std::byte> encode_film(const frame::FilmTile& film);
Expected<frame::FilmTile> decode_film(std::span<const std::byte> bytes);

}  // namespace tessera::wire
