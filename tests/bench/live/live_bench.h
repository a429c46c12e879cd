#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "mediator/base/clock.h"

namespace tessera::tools::bench {

struct LiveOptions {
    std::string scene;  // file; its materials are edited
    std::string backend = "embree";
    std::uint32_t nodes = 2, width = 1280, height = 720;
    std::uint64_t edits = 100;               // sequential, to measure the time to a picture
    std::uint32_t editors = 4, rate = 1000;  // edits per second of all together
    double flood_seconds = 60.0;
};

struct Times {
    std::vector<double> seconds;
    double percentile(double part) const;  // nearest rank; 0 without any
};

struct LiveResults {
    // Sequential edits.
    Times edit_to_answer, edit_to_picture, camera_to_picture;
    // As reported by the master, over the whole run.
    double cancel_p50 = 0, cancel_p99 = 0;
    std::uint64_t cancellations = 0;
    double bytes_per_edit = 0, bytes_per_version = 0;  // to the master; to all nodes
    // Many edits from many editors.
    double flood_seconds = 0;
    std::uint64_t flood_edits = 0, flood_accepted = 0, flood_pictures = 0, versions = 0;
    Times picture_age;  // of each received picture: how long a newer version had been known
    std::uint64_t memory_early = 0, memory_late = 0;  // of the master, after 10 s and at the end
    bool replicas_agree = false;
};

// Starts its own cluster. `report` gets progress messages.
LiveResults run_live(const LiveOptions& options, const std::function<void(const std::string&)>& report,
                     std::stop_token stop);

}  // namespace tessera::tools::bench
