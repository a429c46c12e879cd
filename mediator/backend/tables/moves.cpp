#include <algorithm>
#include <limits>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/materials.h"

namespace tessera::backend {

namespace {

void add_box(glm::dvec3& low, glm::dvec3& high, const Mesh& mesh, const glm::mat3& linear,
             const glm::vec3& translation) {
    for (unsigned corner = 0; corner < 8; ++corner) {
        const glm::vec3 object{(corner & 1u) ? mesh.low.x : mesh.high.x,
                               (corner & 2u) ? mesh.low.y : mesh.high.y,
                               (corner & 4u) ? mesh.low.z : mesh.high.z};
        const glm::dvec3 place = linear * object + translation;
        low = glm::min(low, place);
        high = glm::max(high, place);
    }
}

bool moves_only(const SceneDelta& delta) {
    return !delta.everything && !delta.instances_changed && !delta.lights_changed &&
           delta.geometries.empty() && delta.removed_geometries.empty() && delta.materials.empty() &&
           delta.textures.empty() && !delta.background_changed && !delta.render_origin_changed;
}

// Whether nothing but its place follows from where an instance is: it does not shine, nor move in the
// shutter.
bool is_plain(const SceneTables& tables, const shading::Instance& instance, const Instance& source) {
    return instance.motion < 0 && source.motion.empty() && instance.layers == source.layers &&
           !shading::emits(tables.materials[instance.material]);
}

}  // namespace

double radius_of(const SceneTables& tables, const Lowered& lowered, const MeshCatalog& meshes) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    const Mesh* mesh = nullptr;
    for (std::size_t i = 0; i < tables.instances.size(); ++i) {
        const ObjectId geometry = lowered.instances[i].geometry;  // those of a geometry stand together
        if (i == 0 || geometry != lowered.instances[i - 1].geometry) mesh = meshes.find(geometry);
        if (!(mesh->low.x <= mesh->high.x)) continue;
        const shading::Instance& instance = tables.instances[i];
        if (instance.motion < 0) {
            add_box(low, high, *mesh, instance.linear, instance.translation);
            continue;
        }
        for (const shading::Place& step : places_of(tables, instance)) {
            add_box(low, high, *mesh, step.linear, step.translation);
        }
    }
    const double radius = 0.5 * glm::length(high - low);
    return radius > 0.0 && radius < std::numeric_limits<double>::infinity() ? radius : 1.0;
}

TablesStep update_tables(SceneTables& tables, const scene::Scene& scene, const Lowered& lowered,
                         const MeshCatalog& meshes, const scene::BlobStore& blobs, TexturePyramids& pyramids,
                         const SceneDelta& delta) {
    const auto can_move = [&](std::uint32_t i) {
        return is_plain(tables, tables.instances[i], lowered.instances[i]);
    };
    if (moves_only(delta) && std::ranges::all_of(delta.moved_instances, can_move)) {
        for (const std::uint32_t i : delta.moved_instances) {
            place(tables.instances[i], lowered.instances[i].world_from_object, tables.render_origin);
        }
        // Lights that are infinitely far are chosen by how large the scene is.
        const bool has_distant = tables.scene.light_count > tables.scene.tree_light_count;
        const double radius = has_distant ? radius_of(tables, lowered, meshes) : tables.radius;
        if (radius == tables.radius) return TablesStep::Moved;
    }
    tables = make_tables(scene, lowered, meshes, blobs, pyramids);
    return TablesStep::Made;
}

}  // namespace tessera::backend
