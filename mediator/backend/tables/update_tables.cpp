#include <algorithm>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/materials.h"

namespace tessera::backend {

namespace {

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

TablesUpdate update_tables(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene,
                           const MeshCatalog& meshes, const scene::BlobStore& blobs, MipmapCache& mipmaps,
                           const SceneDelta& delta) {
    const auto can_move = [&](std::uint32_t i) {
        return can_move_in_place(tables, tables.instances[i], flat_scene.instances[i]);
    };
    if (moves_only(delta) && std::ranges::all_of(delta.moved_instances, can_move)) {
        bool has_glass = false;
        for (const std::uint32_t i : delta.moved_instances) {
            shading::Instance& instance = tables.instances[i];
            has_glass = has_glass || is_solid_glass(tables.materials[instance.material]);
            set_transform(instance, flat_scene.instances[i].world_from_object, tables.render_origin);
        }
        const bool nested = (tables.scene.features & shading::FeatureNestedGlass) != 0;
        if (!has_glass || nested == has_nested_glass(tables, flat_scene, meshes)) return TablesUpdate::Moved;
    }
    tables = make_tables(scene, flat_scene, meshes, blobs, mipmaps);
    return TablesUpdate::Rebuilt;
}

}  // namespace tessera::backend
