#pragma once

#include <string>
#include <string_view>

#include "client/display_file/loaded_grid.h"
#include "mediator/base/error.h"

namespace tessera::display_file {

// A warp mesh, for each pixel of a picture: rows from the top, a node on each pixel's centre.
struct LoadedMesh {
    LoadedGrid places;   // u, v of the source picture, from its top left; not a number: shows nothing
    LoadedGrid weights;  // brightness in [0, 1], 1 component
};

// Paul Bourke's text format: the kind of source (2 = rectangular, others too: their u, v are used alike),
// columns and rows of nodes, then a line `x y u v brightness` for each node: x from -aspect to aspect of the
// picture, y from -1 to 1, u and v from the source's lower left. A brightness below 0, or u, v outside of
// [0, 1]: cells around that node are not shown. Between nodes all are bilinear. Errors are
// "NAME:LINE: what is wrong".
Expected<LoadedMesh> parse_mesh(std::string_view text, const std::string& name, std::uint32_t width,
                                std::uint32_t height);
Expected<LoadedMesh> load_mesh(const std::string& path, std::uint32_t width, std::uint32_t height);

}  // namespace tessera::display_file
