#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

namespace tessera::exporting {

// Writes a file in pieces. Throws Error{Io}.
using Sink = std::function<void(std::span<const std::byte>)>;

// Calls write(sink) for a temporary file beside `file`, flushes it to the disk and renames it: after a crash
// the old or the new file is there, in full. Throws Error{Io} naming the file, and what `write` throws; then
// nothing has changed.
void write_durably(const std::filesystem::path& file, const std::function<void(const Sink&)>& write);

}  // namespace tessera::exporting
