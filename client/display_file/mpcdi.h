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
    Flat,         // "2d": each pixel shows a point of a flat picture
    FixedEye,     // "3d": a point of the picture of a frustum
    MovingEye,    // "a3": a point in space
    ShaderLamps,  // "sl": projectors by position and frustum; points if given
};

// Angles in radians. Rotated by yaw (positive: right), then by pitch (up), then by roll (its right side down); edges
// are measured from the resulting direction, positive right and up.
struct MpcdiFrustum {
    double yaw = 0, pitch = 0, roll = 0;
    double left = 0, right = 0, down = 0, up = 0;
};

// A position, and the right, up and forward directions in the file's axes.
struct MpcdiFrame {
    glm::dvec3 position{0.0};
    glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
};

// A projector or screen. Grids are empty when the archive has none; nodes are at pixel centres, rows and positions
// count from the top.
struct MpcdiRegion {
    std::string id, buffer;
    std::uint32_t width = 0, height = 0;                // pixels
    std::uint32_t buffer_width = 0, buffer_height = 0;  // 0: not given
    double x = 0, y = 0, across = 1, down = 1;          // its part of the buffer, from the top left
    std::optional<MpcdiFrustum> frustum;
    std::optional<MpcdiFrame> frame;
    // Flat, FixedEye: u, v in [0, 1] of the region; else x, y, z in metres, right-handed, y up. A node that
    // is NaN is not visible. Three components.
    LoadedGrid warp;
    LoadedGrid weights, lift;  // linear, 1 component
};

struct Mpcdi {
    MpcdiProfile profile = MpcdiProfile::Flat;
    std::vector<MpcdiRegion> regions;
    std::vector<std::string> notices;  // about contents that are not used
};

// Parses an archive, or a single mpcdi.xml that names no files (some tools write projectors so). Errors begin with
// `name`, for the text also its line ("wall.mpcdi: mpcdi.xml:12: ..."), and name the remedy.
Expected<Mpcdi> parse_mpcdi(std::span<const std::byte> bytes, const std::string& name);
Expected<Mpcdi> load_mpcdi(const std::string& path);

}  // namespace tessera::display_file
