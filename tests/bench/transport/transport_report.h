#pragma once

#include <string>
#include <vector>

#include "tests/bench/transport/transport_bench.h"

namespace tessera::tools::bench {

// From so many samples on the slope is measured.
inline constexpr std::uint64_t SlopeFromSpp = 4;

// Geometric mean over the scenes of the time to equal error, relative to Cycles; 0: no scene has both.
double mean_time_to_equal_error(const std::vector<TransportScene>& scenes, const std::string& backend);

std::string transport_text(const TransportScene& scene,
                           const TransportPlan& plan);  // a table for the terminal
std::string transport_json(const std::vector<TransportScene>& scenes, const TransportPlan& plan);
std::string transport_html(const std::vector<TransportScene>& scenes, const TransportPlan& plan);
// Error over time of every scene, as one picture of its own.
std::string transport_svg(const std::vector<TransportScene>& scenes);

}  // namespace tessera::tools::bench
