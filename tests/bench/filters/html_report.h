#pragma once

#include <span>
#include <string>

#include "tests/bench/filters/results.h"

namespace tessera::tools::bench {

// One page that needs nothing else: advice, comparison with a slider, per scene crops, plots and numbers.
std::string as_html(const BenchResults& results);

std::string base64(std::span<const std::byte> bytes);  // RFC 4648

}  // namespace tessera::tools::bench
