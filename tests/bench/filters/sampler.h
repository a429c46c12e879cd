#pragma once

#include <tbb/task_arena.h>

#include <memory>
#include <stop_token>

#include "mediator/backend/backend.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::tools::bench {

// A film that grows: samples [0, spp) of a view, so that every prefix is the film of fewer samples.
class GrowingFilm {
  public:
    const view::View& view() const { return view_; }
    std::uint64_t spp() const { return spp_; }
    double seconds() const { return seconds_; }  // wall-clock time of its samples
    std::uint64_t rays() const { return rays_; }
    frame::FilmTile whole() const;

  private:
    friend class Sampler;
    view::View view_;
    std::uint64_t spp_ = 0;
    double seconds_ = 0.0;
    std::uint64_t rays_ = 0;
    std::vector<frame::FilmTile> tiles_;
};

// Capabilities of the first back-end in the catalog.
backend::Capabilities renderer();

// A back-end in this process with one scene in it.
class Sampler {
  public:
    // The first back-end in the catalog, or another one. Throws Error.
    Sampler(const BenchScene& scene, tbb::task_arena& arena);
    Sampler(const BenchScene& scene, tbb::task_arena& arena, const backend::BackendEntry& entry);

    // With the scene's camera.
    view::View view(std::uint32_t width, std::uint32_t height, frame::ChannelSet channels,
                    view::PathClass path_class, std::uint64_t seed) const;

    backend::Backend& backend() const { return *backend_; }
    std::uint32_t tile() const { return tile_; }  // edge in pixels

    GrowingFilm film(const view::View& view) const;
    // Adds samples until there are `spp`. False: stopped, and the film must not be used.
    bool grow(GrowingFilm& film, std::uint64_t spp, const std::stop_token& stop) const;

  private:
    tbb::task_arena& arena_;
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    std::unique_ptr<backend::Backend> backend_;
    import::CameraInfo camera_;
    std::uint32_t max_bounces_;
    std::uint32_t tile_ = 32;
};

}  // namespace tessera::tools::bench
