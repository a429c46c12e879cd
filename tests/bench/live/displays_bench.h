#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

namespace tessera::tools::bench {

struct DisplaysOptions {
    std::string backend = "null";
    std::uint32_t nodes = 2;
    std::uint32_t columns = 6, rows = 4;
    double seconds = 10.0;
    bool wall = true;  // include the large stereo wall
};

// A head that moves constantly in front of a wall of output processes, so that every frame is new.
struct LockRun {
    std::string name;
    std::uint32_t outputs = 0, width = 0, height = 0;
    bool encrypted = true;
    double seconds = 0;
    std::uint64_t frames = 0;               // shown by all outputs
    std::uint64_t mixed = 0;                // that showed different versions on different outputs: must be 0
    std::uint64_t late = 0;                 // times that an output was dropped from the lock
    double spread_p50 = 0, spread_p99 = 0;  // seconds from the first to the last output that shows a frame
    double master_cpu = 0, nodes_cpu = 0, outputs_cpu = 0;  // processor seconds during the run
    std::uint64_t film_bytes = 0;                           // from the nodes
    double rate() const { return seconds > 0 ? double(frames) / seconds : 0.0; }
    double cpu_per_frame() const {
        return frames > 0 ? (master_cpu + nodes_cpu + outputs_cpu) / double(frames) : 0.0;
    }
};

// One frame of a stereo wall as large as the thesis' (Schwenk: 6 x 4 projectors, 8640 x 4200 pixels an eye).
struct WallRun {
    std::uint64_t pixels = 0;             // of both eyes
    double seconds = 0;                   // from opening the display until all outputs have shown the frame
    std::uint64_t master_peak_bytes = 0;  // peak memory meanwhile
};

struct DisplaysResults {
    std::vector<LockRun> locks;
    WallRun wall;
};

DisplaysResults run_displays(const DisplaysOptions& options,
                             const std::function<void(const std::string&)>& report, std::stop_token stop);

}  // namespace tessera::tools::bench
