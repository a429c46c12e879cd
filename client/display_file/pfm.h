#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "client/display_file/loaded_grid.h"
#include "mediator/base/error.h"

namespace tessera::display_file {

// A portable float map ("PF" of three components, "Pf" of one), either byte order, a node for each pixel's
// centre. Rows are read from the top, as calibration tools write them (MPCDI; pictures in PFM start at the
// bottom). NaN is kept and means an invisible pixel. Errors begin with `name`: wrong header or size, infinite values,
// only NaN.
Expected<LoadedGrid> parse_pfm(std::span<const std::byte> bytes, const std::string& name);
Expected<LoadedGrid> load_pfm(const std::string& path);

// Blend weights or black levels in [0, 1], one component: a PFM, or a PNG of 8 or 16 bits with
// value^gamma (of colours: their mean). Errors as above, and for values outside [0, 1].
Expected<LoadedGrid> parse_weights(std::span<const std::byte> bytes, const std::string& name, double gamma);
Expected<LoadedGrid> load_weights(const std::string& path);  // of a linear picture

}  // namespace tessera::display_file
