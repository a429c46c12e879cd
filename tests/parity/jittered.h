#pragma once

#include "backends/embree/scene_adapter.h"
#include "mediator/frame/film_tile.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::test {

// The Embree back-end with perturbed rays: the components of ray directions, and the position and distance of
// hits, are changed by one float up, one down or not at all, at random.
class JitteredEmbree {
  public:
    explicit JitteredEmbree(const tools::bench::BenchScene& scene);

    frame::FilmTile film(const view::View& view, const Rect& tile, std::uint64_t sample) const;

  private:
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    embree::DeviceHandle device_;
    embree::SceneAdapter adapter_;
};

}  // namespace tessera::test
