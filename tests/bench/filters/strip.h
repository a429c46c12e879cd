#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/filters/results.h"

namespace tessera::tools::bench {

// One crop per filter at 4 spp (or the nearest there is) of one scene, for use in documentation.
struct Strip {
    std::vector<std::byte> png;  // in a grid, in the order of the table
    std::string table;           // Markdown: position, error and time of each
};

// Of the scene where the filters help most. Without crops: empty.
Strip make_strip(const BenchResults& results);

}  // namespace tessera::tools::bench
