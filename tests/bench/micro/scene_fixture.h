#pragma once

#include "backends/embree/scene_adapter.h"
#include "tests/bench/micro/timing.h"

namespace tessera::bench {

// A file of tests/scenes on one thread of Embree, with a view of its first camera.
struct SceneFixture {
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    embree::DeviceHandle device = embree::make_device({.threads = 1, .blobs = blobs});
    embree::SceneAdapter world{device.get(), blobs};
    view::View view;
    scene::ChangeList changes;  // snapshot of the scene

    SceneFixture(const std::string& file, std::uint32_t size);
};

}  // namespace tessera::bench
