#pragma once

#include <filesystem>

#include "mediator/base/error.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

// One file: magic and format version, number, the state's length and bytes, then each block of film with its
// length, all little-endian; BLAKE2b-256 over all of it at the end. Written under a temporary name, synced,
// renamed, and the folder synced, so it exists completely or not at all. Returns its size in bytes; throws
// Error{Io}, Error{OutOfMemory}.
std::uint64_t write_checkpoint(const std::filesystem::path& path, std::uint64_t number,
                               const wire::CheckpointState& state);

// Accepts arbitrary bytes: anything but the complete, intact checkpoint of that number is an Error{InvalidInput}, a
// file that cannot be read Error{Io}.
Expected<wire::CheckpointState> read_checkpoint(const std::filesystem::path& path, std::uint64_t number);

}  // namespace tessera::master
