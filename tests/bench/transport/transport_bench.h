#pragma once

#include <tbb/task_arena.h>

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "client/tools/values.h"
#include "tests/bench/filters/scene_bench.h"
#include "tests/bench/transport/luminance_histogram.h"
#include "tests/bench/transport/path_depths.h"

namespace tessera::tools::bench {

// Error of unfiltered pictures over samples and time, of each back-end and of Cycles.
struct TransportPlan {
    std::filesystem::path output, references, assets;
    std::vector<std::string> scenes, backends;
    std::vector<std::uint64_t> spp;  // ascending
    std::uint64_t reference_spp = 0;
    Size size;
    std::uint32_t seeds = 0, jobs = 1;
    bool cycles = false;
};

// Films of one number of samples. Errors and times are means over the seeds.
struct TransportPoint {
    std::uint64_t spp = 0;
    double seconds = 0.0;  // of sampling one film
    Estimate relmse, trimmed;
    double flip = 0.0;             // HDR-FLIP
    double light = 0.0;            // mean luminance over that of the references
    double light_deviation = 0.0;  // standard error of it, from the noise of the references
    double rays = 0.0;             // per sample
};

// Films of one sample for the histogram of a curve.
inline constexpr std::uint32_t HistogramSeeds = 32;

struct TransportCurve {
    std::string renderer;  // a back-end or "cycles"
    double first_picture_seconds =
        0.0;                    // building the scene, and one sample per pixel; of Cycles: import, then one
    double memory_bytes = 0.0;  // growth of the process by scene and film; 0: unknown
    std::vector<TransportPoint> points;  // ascending
    LuminanceHistogram samples;          // single ones; empty: unknown
    std::vector<PathDepth> depths = {};  // at the most samples; empty: unknown
};

// Adds one of plan.seeds pictures to the means, with its rays per sample if they are known.
void add_picture(const frame::Image& picture, const ReferencePair& truth, double seconds,
                 const TransportPlan& plan, TransportPoint& point);

// How fast the error falls: least squares of log relMSE over log spp, from `from` samples on. 0 without two points.
double slope(const TransportCurve& curve, std::uint64_t from);

// Time to equal error of `curve` over that of `other`, at the most samples of each: relMSE times seconds. 0: unknown.
double time_to_equal_error(const TransportCurve& curve, const TransportCurve& other);

struct TransportScene {
    std::string name, kind, summary;
    std::vector<TransportCurve> curves;
};

// Nothing when it was stopped. Throws Error.
std::optional<TransportScene> measure_transport(const BenchScene& scene, const TransportPlan& plan,
                                                tbb::task_arena& arena, const BenchProgress& progress,
                                                const std::stop_token& stop);

}  // namespace tessera::tools::bench
