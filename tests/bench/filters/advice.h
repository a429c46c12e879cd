#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/filters/results.h"

// Recommendations ("Which filter when") from the results of a run. No filter except `none` is known by name.
namespace tessera::tools::bench {

// The row of the largest size that was measured at these samples.
struct PlacedRow {
    const SizeResult* size = nullptr;
    const Row* row = nullptr;
};
std::vector<PlacedRow> rows_at(const SceneResult& scene, std::uint64_t spp);

// All numbers of samples that were measured, ascending.
std::vector<std::uint64_t> measured_spp(const BenchResults& results);

// The row with the smallest error; for a fixed time, the one with the largest equal-time ratio.
std::optional<PlacedRow> least_error(const SceneResult& scene, std::uint64_t spp);
std::optional<PlacedRow> best_for_time(const SceneResult& scene, std::uint64_t spp);

// Whether a filter stays at most 5 % worse than no filter, from 4 samples on.
struct Convergence {
    std::string filter;
    bool is_declared_consistent = false;
    double worst = 0.0;  // largest relMSE over unfiltered; measured at the small size
    std::string worst_scene;
    std::uint64_t worst_spp = 0;
    // First number of samples at which it is worse than 1.05 x unfiltered, for each scene where that happens.
    struct Exceeded {
        std::string scene;
        std::uint64_t spp = 0;
    };
    std::vector<Exceeded> exceeded;
};
inline constexpr double ConsistencyLimit = 1.05;
std::vector<Convergence> convergence(const BenchResults& results);

// Over all scenes: the geometric mean of the equal-error sample ratio at these samples.
struct Standing {
    std::string filter;
    double ratio = 0.0, worst = 0.0;  // worst: in the scene where it helps least
};
std::vector<Standing> standings(const BenchResults& results, std::uint64_t spp);  // best first

// Sentences of plain text for the top of the page.
std::vector<std::string> advice(const BenchResults& results);

}  // namespace tessera::tools::bench
