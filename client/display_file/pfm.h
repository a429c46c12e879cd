#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "client/display_file/loaded_grid.h"
#include "mediator/base/error.h"

namespace tessera::display_file {

// A portable float map ("PF" of three components, "Pf" of one), either byte order, a node for each pixel's
// centre. Rows are taken from the top, as tools of calibration write them (MPCDI; pictures in PFM go from the
// bottom). What is not a number stays so: nobody sees that pixel. Errors begin with `name`: wrong header or
// size, numbers without end, no number at all.
Expected<LoadedGrid> parse_pfm(std::span<const std::byte> bytes, const std::string& name);
Expected<LoadedGrid> load_pfm(const std::string& path);

// Blend weights or black levels in [0, 1], one component: a PFM, or a PNG of 8 or 16 bits that means
// value^gamma (of colours: the mean). Errors as above, and for values that are not in [0, 1].
Expected<LoadedGrid> parse_weights(std::span<const std::byte> bytes, const std::string& name, double gamma);
Expected<LoadedGrid> load_weights(const std::string& path);  // of a linear picture

}  // namespace tessera::display_file
