#pragma once

#include <string>

#include "tests/bench/backends/backends_results.h"

namespace tessera::tools::bench {

// Medians, and beside them the ratio to the first contender's on the same scene in the same run.
std::string as_table(const BackendsScene& scene);     // for people; a line per measure
std::string as_csv(const BackendsResults& results);   // a line per scene, contender and measure
std::string as_json(const BackendsResults& results);  // with every single measurement

}  // namespace tessera::tools::bench
