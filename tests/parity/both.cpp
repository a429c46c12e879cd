#include "tests/parity/both.h"

#include "mediator/backend/catalog.h"
#include "tests/support/folders.h"

namespace tessera::test {

tools::bench::BenchScene bench_scene(const std::string& name) {
    auto scene = tools::bench::load_scene(name, test::scenes_folder());
    if (!scene) throw scene.error();
    return std::move(*scene);
}

view::View square_view(const tools::bench::BenchScene& scene, std::uint32_t size) {
    using frame::Channel;
    const auto edge = static_cast<std::int32_t>(size);
    return {
        .id = ViewId{1},
        .camera = view::perspective(scene.camera.world_from_camera, scene.camera.camera.vertical_fov, 1.0),
        .width = size,
        .height = size,
        .window = {0, 0, edge, edge},
        .seed = 23,
        .max_bounces = 8,
        .channels = {Channel::Radiance, Channel::Albedo, Channel::Normal, Channel::Depth}};
}

Renderer::Renderer(const std::string& backend, const tools::bench::BenchScene& scene) {
    for (const scene::BlobPtr& blob : scene.blobs) blobs_->insert(blob);
    backend_ = backend::find_backend(backend).make({.blobs = blobs_});
    const auto edit = backend_->begin_edit();
    if (auto applied = edit->apply(scene::snapshot(scene.content)); !applied) throw applied.error();
    if (auto committed = edit->commit(); !committed) throw committed.error();
}

frame::FilmTile Renderer::film(const view::View& view, const Rect& tile, frame::SampleBlock block) const {
    const view::WorkUnit unit{.version = backend_->version(), .tile = tile, .block = block};
    backend::RenderResult result = backend_->render(view, unit, {});
    if (result.status != backend::RenderStatus::Done) {
        throw Error(ErrorCode::Internal, "the unit was not rendered");
    }
    return std::move(result.blocks.at(0));
}

}  // namespace tessera::test
