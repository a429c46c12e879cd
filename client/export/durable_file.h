#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

namespace tessera::exporting {

// Writes a file in pieces. Throws Error{Io}.
using Sink = std::function<void(std::span<const std::byte>)>;

// Calls write(sink) for a temporary file in the same folder, flushes it to disk and renames it to `file`:
// after a crash, either the old or the new file exists completely. Throws Error{Io} naming the file, and
// whatever `write` throws; the old file is then unchanged.
void write_durably(const std::filesystem::path& file, const std::function<void(const Sink&)>& write);

}  // namespace tessera::exporting
