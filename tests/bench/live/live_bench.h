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
    std::uint64_t edits = 100;               // one after the other, for the time to a picture
    std::uint32_t editors = 4, rate = 1000;  // edits per second of all together
    double flood_seconds = 60.0;
};

struct Times {
    std::vector<double> seconds;
    double percentile(double part) const;  // nearest rank; 0 without any
};

struct LiveResults {
    // One edit after the other.
    Times edit_to_answer, edit_to_picture, camera_to_picture;
    // As the master saw them during all of it.
    double cancel_p50 = 0, cancel_p99 = 0;
    std::uint64_t cancellations = 0;
    double bytes_per_edit = 0, bytes_per_version = 0;  // to the master; to all nodes
    // Many edits from many editors.
    double flood_seconds = 0;
    std::uint64_t flood_edits = 0, flood_accepted = 0, flood_pictures = 0, versions = 0;
    Times picture_age;  // of each picture that came: how long something newer had been known
    std::uint64_t memory_early = 0, memory_late = 0;  // of the master, after 10 s and in the end
    bool replicas_agree = false;
};

// Runs a cluster of its own. `tell` hears what is going on.
LiveResults run_live(const LiveOptions& options, const std::function<void(const std::string&)>& tell,
                     std::stop_token stop);

}  // namespace tessera::tools::bench
