#pragma once

#include <string>
#include <string_view>

#include "client/display_file/loaded_grid.h"
#include "mediator/base/error.h"

namespace tessera::display_file {

// A warp mesh, resampled to the pixels of a picture: rows from the top, a node at each pixel's centre.
struct LoadedMesh {
    LoadedGrid source_uv;  // u, v of the source picture, from its top left; NaN: not shown
    LoadedGrid weights;    // brightness in [0, 1], 1 component
};

// Paul Bourke's text format: the type of source (2 = rectangular; others are treated the same),
// columns and rows of nodes, then a line `x y u v brightness` for each node: x from -aspect to aspect of the
// picture, y from -1 to 1, u and v from the source's lower left. A brightness below 0, or u, v outside of
// [0, 1]: cells around that node are not shown. Values are bilinear between nodes. Errors are
// "NAME:LINE: cause".
Expected<LoadedMesh> parse_mesh(std::string_view text, const std::string& name, std::uint32_t width,
                                std::uint32_t height);
Expected<LoadedMesh> load_mesh(const std::string& path, std::uint32_t width, std::uint32_t height);

}  // namespace tessera::display_file
