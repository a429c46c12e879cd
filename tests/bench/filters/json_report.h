#pragma once

#include <string>

#include "tests/bench/filters/results.h"

namespace tessera::tools::bench {

// Everything that was measured but the pictures, as one JSON object.
std::string as_json(const BenchResults& results);

}  // namespace tessera::tools::bench
