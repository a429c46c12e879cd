#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include "client/display/presenter.h"

namespace tessera::client_display {

// Start of the shared memory; the pictures follow, three buffers of picture_count x width x height x 3 bytes.
// A reader loads `sequence`, reads buffer `sequence % 3` and loads `sequence` again: if it grew by two or more, the
// data may be torn.
struct SharedHeader {
    std::uint32_t magic = 0x31534454;  // "TDS1"
    std::uint32_t width = 0, height = 0, picture_count = 1;
    std::array<std::uint64_t, 3> frames{};   // numbers of the frames in the buffers
    std::atomic<std::uint64_t> sequence{0};  // of presented frames; 0 = none yet
};
static_assert(sizeof(SharedHeader) == 48 && std::atomic<std::uint64_t>::is_always_lock_free);

// Creates POSIX shared memory of that name ("/left") and removes it at the end. Throws Error{Io}.
std::unique_ptr<Presenter> make_shared_memory(const std::string& name, const display::Output& output);

}  // namespace tessera::client_display
