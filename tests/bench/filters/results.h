#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/filters/errors.h"

// Results of `tessera bench filters`, the input of the reports.
namespace tessera::tools::bench {

struct PassTime {
    std::string name;
    double seconds = 0.0, bytes_per_pixel = 0.0;
};

// Time of one run of a filter; the fastest of a few.
struct FilterTime {
    double seconds = 0.0;
    std::vector<PassTime> passes;
    double bytes_per_pixel = 0.0;  // of all passes
    double copy_ratio = 0.0;       // time over that of copying as many bytes; 1 = memory bandwidth
};

// is_measured = false: read from the unfiltered curve beyond its ends, where error x samples is constant.
struct Ratio {
    double value = 0.0;  // 0: the error is below the resolution of the references
    bool is_measured = false;
};

// A filter's relMSE relative to the unfiltered picture's.
struct RelativeToUnfiltered {
    double to_unfiltered = 0.0;  // relMSE over that of `none` on the same samples
    Ratio equal_error;           // equivalent spp: samples that unfiltered needs for this error, over spp
    Ratio equal_time;            // error of unfiltered after this row's time, over this row's error
};

struct Row {
    std::string filter;
    std::uint64_t spp = 0;
    SquaredErrors errors;
    PerceptualErrors seen;
    FilterTime time;
    double sampling_seconds = 0.0;      // spp samples with this filter's channels
    RelativeToUnfiltered all, trimmed;  // by relMSE over all pixels, and by the trimmed one
    std::vector<std::string> notes;
    std::vector<std::uint8_t> crop;  // 8-bit sRGB as displayed; empty: not kept
};

struct SizeResult {
    std::uint32_t width = 0, height = 0;
    std::uint64_t reference_spp = 0;
    double noise_mse = 0.0, noise_relmse = 0.0;  // of one reference, by the difference of the two
    double copy_bytes_per_second = 0.0;          // read + written, of a working set of this size
    std::vector<Row> rows;                       // by spp, then in the order of the filters
    std::uint32_t crop_width = 0, crop_height = 0;
    std::vector<std::uint8_t> reference_crop;

    const Row* find(const std::string& filter, std::uint64_t spp) const;
};

// A slow orbit of the camera, one film of `spp` samples per view, one filter for all of them.
struct PathRow {
    std::string filter;
    std::uint64_t spp = 0;
    RelativeErrors temporal;  // relMSE of the steps from view to view
    RelativeErrors relmse;    // mean over the second half of the path, with a history
};
struct PathResult {
    std::uint32_t views = 0;
    double degrees_per_view = 0.0;
    std::uint64_t reference_spp = 0;
    std::vector<PathRow> rows;
};

struct SceneResult {
    std::string name, kind, summary, content;  // content: the scene's hash
    std::vector<SizeResult> sizes;             // small first
    PathResult path;
};

// A filter at 4 samples per pixel of the first scene, at a size that others have published times for.
struct SpeedRow {
    std::string filter;
    std::uint32_t width = 0, height = 0;
    double seconds = 0.0;
    double published_seconds = 0.0;
    std::string hardware, source;
};
// The same at the plan's largest size, with each value of a parameter that chooses among methods.
struct VariantRow {
    std::string filter;
    FilterTime time;
    RelativeErrors relmse;
};
inline constexpr std::uint64_t SpeedSpp = 4;
struct SpeedResult {
    std::string scene;
    std::uint32_t width = 0, height = 0;  // of the variants
    std::vector<SpeedRow> published;
    std::vector<VariantRow> variants;
};

struct FilterInfo {
    std::string text, name, summary, source, channels, path_class;
    bool is_consistent = false, is_temporal = false;
};

struct BenchResults {
    std::string software, backend;
    std::uint32_t threads = 0;
    double seconds = 0.0;  // of the whole run
    std::vector<FilterInfo> filters;
    std::vector<SceneResult> scenes;
    SpeedResult speed;
    std::vector<std::string> notes;
};

}  // namespace tessera::tools::bench
