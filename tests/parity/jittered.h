#pragma once

#include "backends/embree/world.h"
#include "mediator/frame/film_tile.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::test {

// The Embree back-end's rays under the same transport, but components of the directions it asks in, and the
// place and distance of the hits it finds, are one float higher, one lower or as they are, at random.
class JitteredEmbree {
  public:
    explicit JitteredEmbree(const tools::bench::BenchScene& scene);

    frame::FilmTile film(const view::View& view, const Rect& tile, std::uint64_t sample) const;

  private:
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    embree::DeviceHandle device_;
    embree::World world_;
};

}  // namespace tessera::test
