#include "tests/bench/backends/traversal_rays.h"

#include <cmath>
#include <glm/common.hpp>

#include "mediator/backend/tables/tables.h"
#include "mediator/backend/tables/view_record.h"
#include "mediator/base/random.h"
#include "mediator/shading/bvh_trace.h"
#include "mediator/shading/camera.h"
#include "mediator/shading/sampling.h"
#include "mediator/shading/surfaces.h"
#include "mediator/shading/triangle_points.h"

namespace tessera::tools::bench {

namespace {

using shading::RayQuery;

constexpr std::uint32_t Tile = 8;

// The shading tables of the scene on the host.
class HostScene {
  public:
    HostScene(const BenchScene& scene, const std::shared_ptr<scene::BlobStore>& blobs) : meshes_(blobs) {
        backend::ShadowScene shadow;
        if (auto applied = shadow.apply(scene::snapshot(scene.content)); !applied) throw applied.error();
        meshes_.update(shadow.scene(), shadow.take_delta());
        backend::MipmapCache mipmaps;
        tables_ = backend::make_tables(shadow.scene(), shadow.flat_scene(), meshes_, *blobs, mipmaps);
        scene_ = backend::on_host(tables_);
    }
    const shading::Scene& scene() const { return scene_; }
    const glm::dvec3& render_origin() const { return tables_.render_origin; }

  private:
    backend::MeshCatalog meshes_;
    backend::SceneTables tables_;
    shading::Scene scene_;
};

std::vector<RayQuery> camera_rays(const shading::View& view, std::uint32_t edge) {
    std::vector<RayQuery> rays;
    for (std::uint32_t i = 0; i < edge * edge; ++i) {
        const std::uint32_t tile = i / (Tile * Tile), in_tile = i % (Tile * Tile), tiles = edge / Tile;
        const shading::Ray ray = shading::camera_ray(view, tile % tiles * Tile + in_tile % Tile,
                                                     tile / tiles * Tile + in_tile / Tile, glm::vec2(0.5f));
        rays.push_back({ray.origin, shading::NearestHit, ray.direction, shading::infinity()});
    }
    return rays;
}

}  // namespace

RaySets ray_sets(const BenchScene& scene, std::shared_ptr<scene::BlobStore> blobs, std::uint32_t count,
                 tessera::bench::RayCaster& caster) {
    const auto edge = static_cast<std::uint32_t>(std::ceil(std::sqrt(double(count)) / Tile)) * Tile;
    const HostScene host(scene, blobs);
    const view::View view{
        .camera = view::perspective(scene.camera.world_from_camera, scene.camera.camera.vertical_fov, 1.0),
        .width = edge,
        .height = edge};
    RaySets sets{.primary = camera_rays(backend::make_view(view, host.render_origin()), edge)};
    caster.take(sets.primary, tessera::bench::RayQueryKind::Closest);
    caster.cast();
    const std::vector<shading::Hit> hits = caster.hits();
    std::vector<shading::Surface> seen;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (hits[i].instance == shading::NoInstance) continue;
        seen.push_back(shading::make_surface(host.scene(), hits[i], sets.primary[i].direction, 0.0f,
                                             shading::no_media(), 0.0f));
    }
    CounterRandom random(9);
    for (const shading::Surface& at : seen) {
        const auto start = [&](const glm::vec3& direction) {
            return shading::leave_surface(at.position, at.error, at.geometric_normal, direction);
        };
        const glm::vec2 u(random.uniform(), random.uniform());
        const glm::vec3 out =
            shading::frame_around(at.geometric_normal) * shading::sample_cosine_hemisphere(u);
        sets.bounce.push_back({start(out), shading::NearestHit, out, shading::infinity()});
        const glm::vec3 target =
            glm::mix(seen[random.below(seen.size())].position, sets.primary[0].origin, 0.1f);
        const glm::vec3 direction = target - at.position;
        sets.shadow.push_back({start(direction), shading::NearestHit, direction, 0.999f});
    }
    return sets;
}

}  // namespace tessera::tools::bench
