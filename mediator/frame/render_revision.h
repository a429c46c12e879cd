#pragma once

#include <cstdint>
#include <string>

// Part of the kind of a back-end, since equal kinds give equal bits: film of different render revisions is never
// merged.
namespace tessera::frame {

// Raised by the commit that changes a film hash in tests/process/film_hashes.json.
inline constexpr std::uint32_t RenderRevision = 6;

// Appends it to the kind of a back-end: "null-1" becomes "null-1/r1".
inline std::string with_render_revision(const std::string& kind) {
    return kind + "/r" + std::to_string(RenderRevision);
}

}  // namespace tessera::frame
