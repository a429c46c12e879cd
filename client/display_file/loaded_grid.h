#pragma once

#include <cstdint>
#include <vector>

namespace tessera::display_file {

// What a calibration file says about an output's picture, node by node, rows from the top, components
// interleaved. Which of the picture's places the nodes stand for is the file format's matter: the loaders say
// so.
struct LoadedGrid {
    std::uint32_t columns = 0, rows = 0, components = 0;
    std::vector<float> values;  // columns x rows x components
};

}  // namespace tessera::display_file
