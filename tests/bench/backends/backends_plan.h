#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "client/tools/values.h"
#include "tests/bench/backends/contenders.h"

namespace tessera::tools::bench {

// What `tessera bench backends` is asked to do. As typed.
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
    struct Entrant {
        tessera::bench::Contender contender;
        std::string device;
    };
    std::vector<Entrant> entrants;  // the first is what the others are compared with
    Size size;
    std::uint64_t spp = 1;
    std::uint32_t rays = 0, repeat = 1, jobs = 1;
};

// InvalidInput with the option's name and what would be right.
Expected<BackendsPlan> understand(const BackendsOptions& options,
                                  const std::vector<tessera::bench::Contender>& contenders);

}  // namespace tessera::tools::bench
