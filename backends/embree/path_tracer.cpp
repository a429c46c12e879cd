#include "backends/embree/path_tracer.h"

#include "backends/embree/context.h"
#include "mediator/backend/tables/media.h"
#include "mediator/backend/tables/view_record.h"
#include "mediator/shading/trace.h"

namespace tessera::embree {

PathTracer::PathTracer(const backend::SceneTables& tables, RTCScene top, const view::View& view,
                       Strategy strategy)
    : tables_(tables),
      scene_(backend::on_host(tables)),
      camera_keys_(backend::camera_keys(view.camera, tables.render_origin)),
      view_(backend::make_view(view, tables.render_origin)),
      top_(top) {
    view_.containing_media = backend::media_around(tables, view_);
    view_.camera_keys.items = camera_keys_.data();
    scene_.features = backend::features_for(tables, view_);
    view_.strategy = static_cast<std::uint32_t>(strategy);
    kernel_ = &kernel_for(scene_.features);
}

PathSample PathTracer::trace(std::uint32_t x, std::uint32_t y, std::uint64_t sample, std::uint64_t& rays,
                             std::vector<std::string>* path_log) const {
    if (path_log == nullptr) return kernel_->trace(scene_, view_, top_, x, y, sample, rays);
    const float time = shading::sample_time(scene_.features, view_, x, y, sample);
    const shading::Path path =
        shading::trace_sample(Context{{path_log}, {scene_, view_, top_, time}}, x, y, sample);
    rays += path.rays;
    return path.found;
}

std::optional<backend::SkyCells> PathTracer::make_sky_cells(std::uint32_t threads,
                                                            const std::stop_token& stop) const {
    const backend::SkyRays rays{
        .trace_path =
            [&](std::uint32_t x, std::uint32_t y, std::uint64_t sample,
                std::vector<backend::SkyPlace>& places) {
                const float time = shading::sample_time(scene_.features, view_, x, y, sample);
                (void)shading::trace_sample(Context{{.sky_places = &places}, {scene_, view_, top_, time}}, x,
                                            y, sample);
            },
        .sees_sky =
            [&](const backend::SkyPlace& place, const glm::vec3& direction, std::uint32_t number) {
                shading::ThinWalls walls;
                return !trace_occluded(Context{{}, {scene_, view_, top_, 0.0f}}, place.origin, direction,
                                       shading::infinity(), shading::Sampler(number, 0u), walls);
            }};
    return backend::make_sky_cells(tables_, view_, rays, threads, stop);
}

}  // namespace tessera::embree
