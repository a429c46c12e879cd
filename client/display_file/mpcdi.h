#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/display_file/loaded_grid.h"
#include "mediator/base/error.h"

// VESA's Multiple Projection Common Data Interchange, 1.0 and 2.0: a ZIP archive with mpcdi.xml, warps as PFM
// and weights as PNG.
namespace tessera::display_file {

enum class MpcdiProfile {
    Flat,         // "2d": each pixel shows a place of a flat picture
    FixedEye,     // "3d": a place of the picture of a frustum
    MovingEye,    // "a3": a point in space
    ShaderLamps,  // "sl": projectors by position and frustum; points where they are given
};

// Angles in radians. First it turns by yaw (positive: right), then by pitch (up), then by roll (its right
// side down); edges are measured from where it looks then, positive right and up.
struct MpcdiFrustum {
    double yaw = 0, pitch = 0, roll = 0;
    double left = 0, right = 0, down = 0, up = 0;
};

// A position, and what right, up and forward are in the file's axes.
struct MpcdiFrame {
    glm::dvec3 position{0.0};
    glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
};

// A projector or screen. Grids are empty when the archive has none; nodes are pixels' centres, rows and
// places count from the top.
struct MpcdiRegion {
    std::string id, buffer;
    std::uint32_t width = 0, height = 0;                // pixels
    std::uint32_t buffer_width = 0, buffer_height = 0;  // 0: not said
    double x = 0, y = 0, across = 1, down = 1;          // its part of the buffer, from the top left
    std::optional<MpcdiFrustum> frustum;
    std::optional<MpcdiFrame> frame;
    // Flat, FixedEye: u, v in [0, 1] of the region; else x, y, z in metres, right-handed, y up. A node that
    // is not a number sees nothing. Three components.
    LoadedGrid warp;
    LoadedGrid weights, lift;  // linear, 1 component
};

struct Mpcdi {
    MpcdiProfile profile = MpcdiProfile::Flat;
    std::vector<MpcdiRegion> regions;
    std::vector<std::string> notices;  // what it holds and nobody uses, for people
};

// Of an archive, or of an mpcdi.xml that names no files and stands alone (some tools write projectors so).
// Errors begin with `name`, in the text with its line ("wall.mpcdi: mpcdi.xml:12: ..."), and say the remedy.
Expected<Mpcdi> parse_mpcdi(std::span<const std::byte> bytes, const std::string& name);
Expected<Mpcdi> load_mpcdi(const std::string& path);

}  // namespace tessera::display_file
