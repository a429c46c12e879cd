#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/filters/results.h"

namespace tessera::tools::bench {

// One crop per filter at 4 spp (or the nearest there is) of one scene, to be shown in a text.
struct Strip {
    std::vector<std::byte> png;  // side by side and below each other, in the order of the table
    std::string table;           // Markdown: where each is, its error and time
};

// Of the scene where the filters help most. Without crops: empty.
Strip make_strip(const BenchResults& results);

}  // namespace tessera::tools::bench
