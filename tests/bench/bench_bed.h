#pragma once

#include <algorithm>
#include <ctime>

#include "backends/embree/world.h"

namespace tessera::bench {

// A file of tests/scenes on one thread of Embree, seen by its first camera.
struct Bed {
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    embree::DeviceHandle device = embree::make_device({.threads = 1, .blobs = blobs});
    embree::World world{device.get(), blobs};
    view::View view;
    scene::ChangeList changes;  // that lead to the scene

    Bed(const std::string& file, std::uint32_t size);
};

// Of this thread on a processor: others may be at work, too.
inline double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

inline double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

}  // namespace tessera::bench
