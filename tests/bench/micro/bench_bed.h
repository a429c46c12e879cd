#pragma once

#include "backends/embree/world.h"
#include "tests/bench/micro/timing.h"

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

}  // namespace tessera::bench
