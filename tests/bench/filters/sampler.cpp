#include "tests/bench/filters/sampler.h"

#include <algorithm>
#include <atomic>

#include "mediator/backend/catalog.h"
#include "mediator/base/clock.h"
#include "mediator/base/parallel.h"
#include "mediator/frame/merge.h"

namespace tessera::tools::bench {

frame::FilmTile GrowingFilm::whole() const {
    frame::FilmTile film(view_.window, {0, 0}, view_.channels);
    for (const frame::FilmTile& tile : tiles_) paste(film, tile);
    return film;
}

backend::Capabilities renderer() {
    return backend::catalog().front().make({.blobs = std::make_shared<scene::BlobStore>()})->capabilities();
}

Sampler::Sampler(const BenchScene& scene, tbb::task_arena& arena)
    : Sampler(scene, arena, backend::catalog().front()) {}

Sampler::Sampler(const BenchScene& scene, tbb::task_arena& arena, const backend::BackendEntry& entry)
    : arena_(arena), camera_(scene.camera), max_bounces_(scene.max_bounces) {
    for (const scene::BlobPtr& blob : scene.blobs) blobs_->insert(blob);
    backend_ = entry.make({.threads = static_cast<std::uint32_t>(arena.max_concurrency()), .blobs = blobs_});
    const auto edit = backend_->begin_edit();
    if (auto applied = edit->apply(scene::snapshot(scene.content)); !applied) throw applied.error();
    if (auto committed = edit->commit(); !committed) throw committed.error();
    tile_ = backend_->capabilities().preferred_tile;
}

view::View Sampler::view(std::uint32_t width, std::uint32_t height, frame::ChannelSet channels,
                         view::PathClass path_class, std::uint64_t seed) const {
    return {.id = ViewId{1},
            .camera = view::perspective(camera_.world_from_camera, camera_.camera.vertical_fov,
                                        double(width) / double(height)),
            .width = width,
            .height = height,
            .window = {0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)},
            .seed = seed,
            .max_bounces = max_bounces_,
            .path_class = path_class,
            .channels = channels};
}

GrowingFilm Sampler::film(const view::View& view) const {
    GrowingFilm film;
    film.view_ = view;
    const auto edge = static_cast<std::int32_t>(tile_);
    for (std::int32_t y = 0; y < view.window.height; y += edge) {
        for (std::int32_t x = 0; x < view.window.width; x += edge) {
            film.tiles_.emplace_back(intersection({x, y, edge, edge}, view.window), frame::SampleBlock{0, 0},
                                     view.channels);
        }
    }
    return film;
}

bool Sampler::grow(GrowingFilm& film, std::uint64_t spp, const std::stop_token& stop) const {
    const SteadyClock clock;
    const TimePoint started = clock.now();
    const std::vector<frame::SampleBlock> blocks = frame::aligned_blocks(film.spp_, spp);
    std::atomic<bool> whole = true;
    std::atomic<std::uint64_t> rays = 0;
    parallel_for(arena_, film.tiles_.size(), [&](std::size_t i) {
        frame::FilmTile& tile = film.tiles_[i];
        for (const frame::SampleBlock& block : blocks) {
            view::WorkUnit unit{.version = backend_->version(), .tile = tile.rect, .block = block};
            backend::RenderResult result = backend_->render(film.view_, unit, stop);
            if (result.status != backend::RenderStatus::Done) {
                whole = false;
                return;
            }
            rays += result.rays;
            if (block.first == 0) {
                tile = std::move(result.blocks.front());
            } else {
                merge(tile, result.blocks.front());
            }
        }
    });
    film.spp_ = spp;
    film.rays_ += rays;
    film.seconds_ += seconds(clock.now() - started);
    return whole;
}

}  // namespace tessera::tools::bench
