#pragma once

#include <string>

#include "tests/bench/backends/backends_results.h"

namespace tessera::tools::bench {

// Medians, and their ratios to those of the first target on the same scene in the same run.
std::string as_table(const BackendsScene& scene);     // human-readable; a line per measure
std::string as_csv(const BackendsResults& results);   // a line per scene, target and measure
std::string as_json(const BackendsResults& results);  // with every single measurement

}  // namespace tessera::tools::bench
