#pragma once

#include <string>

#include "tests/bench/filters/results.h"

// The page's tables, each with a heading and a line that says how to read it.
namespace tessera::tools::bench {

std::string filter_table(const BenchResults& results);       // which there are
std::string winner_table(const BenchResults& results);       // best filter per scene and spp
std::string convergence_table(const BenchResults& results);  // filters x samples: worst error over unfiltered
std::string speed_table(const BenchResults& results);        // filters: time, bytes, distance from a copy
std::string method_tables(const SpeedResult& speed);         // other methods, and published times
std::string size_table(const SizeResult& size);
std::string path_table(const PathResult& path);

}  // namespace tessera::tools::bench
