#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "client/tools/values.h"
#include "mediator/filter/choice.h"

namespace tessera::tools::bench {

// Options of `tessera bench filters` as typed.
struct BenchOptions {
    std::string output = "bench-filters", references, assets = "tests/scenes";
    std::string scenes, filters;  // "" = all
    std::string spp = "1,4,16,64,256,1024";
    std::string size = "192x108", large = "960x540";
    std::uint64_t reference_spp = 1024;
    std::uint32_t jobs = 0;
    bool quick = false, json = false;
};

// One picture size and its measurements.
struct SizePlan {
    Size size;
    std::vector<std::uint64_t> spp;  // ascending
    std::uint64_t reference_spp = 0;
};

// The parsed options.
struct BenchPlan {
    std::filesystem::path output, references, assets;
    std::vector<std::string> scenes;
    std::vector<filter::Choice> filters;  // the first is `none`, which all are compared with
    std::vector<std::string> left_out;    // for the user: filters that this machine cannot run, and why
    std::vector<SizePlan> sizes;          // of one scene, small first
    std::vector<std::uint64_t> path_spp;  // samples per view of the camera path; empty: no path
    std::uint32_t path_views = 16;
    std::uint64_t path_reference_spp = 32;
    bool measures_speed = true;  // at the sizes of the sources, and of other methods
    std::uint32_t jobs = 1;
};

// "4,16,64", ascending without repetitions. InvalidInput names --spp.
Expected<std::vector<std::uint64_t>> parse_spp(const std::string& text);

// InvalidInput names the option and the remedy.
Expected<BenchPlan> parse_options(const BenchOptions& options, std::span<const filter::FilterEntry> table);

}  // namespace tessera::tools::bench
