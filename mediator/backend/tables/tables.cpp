#include "mediator/backend/tables/tables.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mediator/backend/tables/parts.h"

namespace tessera::backend {

namespace {

std::array<float, 256> make_srgb_values() {
    std::array<float, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double c = static_cast<double>(i) / 255.0;
        values[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return values;
}

template <class Array>
void set_address(Array& array, const scene::BlobPtr& blob, const BlobAddress& address_of) {
    if (blob) array.items = reinterpret_cast<decltype(array.items)>(address_of(blob));
}

// The layer masks in use; equal masks mostly come in runs.
std::vector<std::uint32_t> masks_of(const FlatScene& flat_scene) {
    std::vector<std::uint32_t> masks;
    const auto add = [&](std::uint32_t mask) {
        if (masks.empty() || masks.back() != mask) masks.push_back(mask);
    };
    for (const Instance& instance : flat_scene.instances) add(instance.layers);
    for (const PlacedLight& light : flat_scene.lights) add(light.layers);
    std::ranges::sort(masks);
    masks.erase(std::ranges::unique(masks).begin(), masks.end());
    return masks;
}

}  // namespace

std::span<const float> srgb_values() {
    static const std::array<float, 256> values = make_srgb_values();
    return values;
}

void set_addresses(SceneTables& tables, const BlobAddress& address_of) {
    for (std::size_t i = 0; i < tables.textures.size(); ++i) {
        set_address(tables.textures[i].texels, tables.texels[i], address_of);
        set_address(tables.textures[i].levels, tables.levels[i], address_of);
    }
    for (std::size_t i = 0; i < tables.meshes.size(); ++i) {
        const SceneTables::Arrays& blobs = tables.arrays[i];
        shading::Mesh& mesh = tables.meshes[i];
        set_address(mesh.positions, blobs.positions, address_of);
        set_address(mesh.triangles, blobs.triangles, address_of);
        set_address(mesh.normals, blobs.normals, address_of);
        set_address(mesh.tangents, blobs.tangents, address_of);
        set_address(mesh.colors, blobs.colors, address_of);
        set_address(mesh.tex_coords, blobs.tex_coords, address_of);
        set_address(mesh.tex_coords_1, blobs.tex_coords_1, address_of);
    }
    for (std::size_t i = 0; i < tables.mesh_keys.size(); ++i) {
        set_address(tables.mesh_keys[i].positions, tables.key_arrays[i].positions, address_of);
        set_address(tables.mesh_keys[i].normals, tables.key_arrays[i].normals, address_of);
    }
    set_address(tables.scene.environment.map.texels, tables.environment_texels, address_of);
}

shading::Scene on_host(const SceneTables& tables) {
    shading::Scene scene = tables.scene;
    scene.textures.items = tables.textures.data();
    scene.materials.items = tables.materials.data();
    scene.extras.items = tables.extras.data();
    scene.surface_shaders.items = tables.surface_shaders.data();
    scene.meshes.items = tables.meshes.data();
    scene.mesh_keys.items = tables.mesh_keys.data();
    scene.transform_keys.items = tables.transform_keys.data();
    scene.motions.items = tables.motions.data();
    scene.media.items = tables.media.data();
    scene.instances.items = tables.instances.data();
    scene.lights.items = tables.lights.data();
    scene.emitters.items = tables.emitters.data();
    scene.light_nodes.items = tables.light_nodes.data();
    scene.cdfs.items = tables.cdfs.data();
    scene.srgb.items = srgb_values().data();
    scene.energy.items = energy_values().data();
    return scene;
}

std::uint32_t features_for(const SceneTables& tables, const shading::View& view) {
    const bool sees_all =
        std::ranges::all_of(tables.layers, [&](std::uint32_t mask) { return (mask & view.layers) != 0; });
    return tables.scene.features | (sees_all ? 0u : shading::FeatureLayers) |
           (view.camera_key_intervals > 0 ? shading::FeatureCameraMotion : 0u);
}

SceneTables make_tables(const scene::Scene& scene, const FlatScene& flat_scene, const MeshCatalog& meshes,
                        const scene::BlobStore& blobs, MipmapCache& mipmaps) {
    SceneTables tables;
    if (const auto* root = scene.find_as<scene::Root>(scene::RootId)) {
        tables.render_origin = root->render_origin;
    }
    const Indices textures = add_textures(tables, scene, flat_scene, meshes, blobs, mipmaps);
    const Indices materials = add_materials(tables, scene, textures);
    add_instances(tables, flat_scene, meshes, materials);
    mark_shadow_catchers(tables, scene, flat_scene, meshes);
    add_media(tables, scene, flat_scene, meshes, textures);
    tables.layers = masks_of(flat_scene);
    add_environment(tables, scene, textures);
    add_lights(tables, scene, flat_scene);
    return tables;
}

}  // namespace tessera::backend
