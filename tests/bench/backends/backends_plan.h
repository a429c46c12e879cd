#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "client/tools/values.h"
#include "tests/bench/backends/bench_targets.h"

namespace tessera::tools::bench {

// Options of `tessera bench backends` as typed.
struct BackendsOptions {
    std::string output, assets = "tests/scenes";
    std::string scenes, backends;  // "" = all
    std::string device;
    std::string size = "256x144";
    std::uint64_t spp = 8;
    std::uint32_t rays = 1u << 18, repeat = 5, jobs = 0;
    bool json = false;
};

struct BackendsPlan {
    std::filesystem::path output, assets;  // output: empty for none
    std::vector<std::string> scenes;
    struct Target {
        tessera::bench::BenchTarget target;
        std::string device;
    };
    std::vector<Target> targets;  // the others are compared with the first
    Size size;
    std::uint64_t spp = 1;
    std::uint32_t rays = 0, repeat = 1, jobs = 1;
};

// InvalidInput names the option and the accepted values.
Expected<BackendsPlan> parse_options(const BackendsOptions& options,
                                     const std::vector<tessera::bench::BenchTarget>& targets);

}  // namespace tessera::tools::bench
