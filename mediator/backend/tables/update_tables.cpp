#include <algorithm>
#include <glm/vector_relational.hpp>
#include <limits>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/materials.h"

namespace tessera::backend {

namespace {

void add_box(Bounds& bounds, const Mesh& mesh, const glm::mat3& linear, const glm::vec3& translation) {
    for (unsigned corner = 0; corner < 8; ++corner) {
        const glm::vec3 object{(corner & 1u) ? mesh.low.x : mesh.high.x,
                               (corner & 2u) ? mesh.low.y : mesh.high.y,
                               (corner & 4u) ? mesh.low.z : mesh.high.z};
        const glm::dvec3 position = linear * object + translation;
        bounds.low = glm::min(bounds.low, position);
        bounds.high = glm::max(bounds.high, position);
    }
}

// Whether an instance lies strictly inside the bounds, so that it does not determine them.
bool is_strictly_inside(const Bounds& bounds, const Mesh& mesh, const shading::Instance& instance) {
    if (!(mesh.low.x <= mesh.high.x)) return true;
    Bounds own;
    add_box(own, mesh, instance.linear, instance.translation);
    return glm::all(glm::lessThan(bounds.low, own.low)) && glm::all(glm::lessThan(own.high, bounds.high));
}

bool moves_only(const SceneDelta& delta) {
    return !delta.everything && !delta.instances_changed && !delta.lights_changed &&
           delta.geometries.empty() && delta.removed_geometries.empty() && delta.materials.empty() &&
           delta.textures.empty() && !delta.background_changed && !delta.render_origin_changed;
}

// Whether only its own record depends on an instance's transform: it has no emission, no motion and the same layers.
bool can_move_in_place(const SceneTables& tables, const shading::Instance& instance, const Instance& source) {
    return instance.motion < 0 && source.motion.empty() && instance.layers == source.layers &&
           !shading::emits(tables.materials[instance.material]);
}

}  // namespace

Bounds bounds_of(const SceneTables& tables, const shading::Instance& instance, const Mesh& mesh) {
    Bounds bounds;
    if (!(mesh.low.x <= mesh.high.x)) return bounds;
    for (const shading::Affine3x4& step : transform_keys_of(tables, instance)) {
        add_box(bounds, mesh, step.linear, step.translation);
    }
    return bounds;
}

Bounds bounds_of(const SceneTables& tables, const FlatScene& flat_scene, const MeshCatalog& meshes) {
    Bounds bounds;
    for (std::size_t i = 0; i < tables.instances.size(); ++i) {
        const Bounds own =
            bounds_of(tables, tables.instances[i], *meshes.find(flat_scene.instances[i].geometry));
        bounds.low = glm::min(bounds.low, own.low);
        bounds.high = glm::max(bounds.high, own.high);
    }
    return bounds;
}

double radius_of(const Bounds& bounds) {
    const double radius = 0.5 * glm::length(bounds.high - bounds.low);
    return radius > 0.0 && radius < std::numeric_limits<double>::infinity() ? radius : 1.0;
}

TablesUpdate update_tables(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene,
                           const MeshCatalog& meshes, const scene::BlobStore& blobs, MipmapCache& mipmaps,
                           const SceneDelta& delta) {
    const auto can_move = [&](std::uint32_t i) {
        return can_move_in_place(tables, tables.instances[i], flat_scene.instances[i]);
    };
    if (moves_only(delta) && std::ranges::all_of(delta.moved_instances, can_move)) {
        bool same_bounds = true, has_glass = false;
        for (const std::uint32_t i : delta.moved_instances) {
            const Mesh& mesh = *meshes.find(flat_scene.instances[i].geometry);
            shading::Instance& instance = tables.instances[i];
            has_glass = has_glass || is_solid_glass(tables.materials[instance.material]);
            same_bounds = same_bounds && is_strictly_inside(tables.bounds, mesh, instance);
            set_transform(instance, flat_scene.instances[i].world_from_object, tables.render_origin);
            same_bounds = same_bounds && is_strictly_inside(tables.bounds, mesh, instance);
        }
        const bool nested = (tables.scene.features & shading::FeatureNestedGlass) != 0;
        const bool same_nesting = !has_glass || nested == has_nested_glass(tables, flat_scene, meshes);
        if (same_bounds && same_nesting) return TablesUpdate::Moved;
        // The power of infinite lights depends on the size of the scene.
        const double radius = radius_of(tables.bounds);
        tables.bounds = bounds_of(tables, flat_scene, meshes);
        const bool has_distant = tables.scene.light_count > tables.scene.tree_light_count;
        const bool same_lights = !has_distant || radius_of(tables.bounds) == radius;
        if (same_lights && same_nesting) return TablesUpdate::Moved;
    }
    tables = make_tables(scene, flat_scene, meshes, blobs, mipmaps);
    return TablesUpdate::Rebuilt;
}

}  // namespace tessera::backend
