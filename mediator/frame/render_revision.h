#pragma once

#include <cstdint>
#include <string>

// Film of different render revisions is never merged: equal kinds of back-end give equal bits, as long as the
// renderers themselves are the same.
namespace tessera::frame {

// Raised by the commit that changes a film hash in tests/process/film_hashes.json.
inline constexpr std::uint32_t RenderRevision = 1;

// What back-ends call their kind: "null-1" becomes "null-1/r1".
inline std::string with_render_revision(const std::string& kind) {
    return kind + "/r" + std::to_string(RenderRevision);
}

}  // namespace tessera::frame
