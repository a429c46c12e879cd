#pragma once

#include <cstdint>
#include <vector>

namespace tessera::display_file {

// Values of a calibration file over an output's picture, node by node, rows from the top, components interleaved. The
// positions of the nodes depend on the file format and are documented by the loaders.
struct LoadedGrid {
    std::uint32_t columns = 0, rows = 0, components = 0;
    std::vector<float> values;  // columns x rows x components
};

}  // namespace tessera::display_file
