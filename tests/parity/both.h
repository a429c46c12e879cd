#pragma once

#include <memory>
#include <string>

#include "mediator/backend/backend.h"
#include "mediator/frame/film_tile.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::test {

// A benchmark scene: procedural ones by name, the others from tests/scenes.
tools::bench::BenchScene bench_scene(const std::string& name);

// With the scene's camera and 8 bounces; radiance, albedo, normal and depth.
view::View square_view(const tools::bench::BenchScene& scene, std::uint32_t size);

// A back-end of the catalog with the scene in it.
class Renderer {
  public:
    Renderer(const std::string& backend, const tools::bench::BenchScene& scene);

    frame::FilmTile film(const view::View& view, const Rect& tile, frame::SampleBlock block) const;

  private:
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    std::unique_ptr<backend::Backend> backend_;
};

}  // namespace tessera::test
