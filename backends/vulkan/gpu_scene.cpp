#include "backends/vulkan/gpu_scene.h"

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/raster/raster_jobs.h"

namespace tessera::vulkan {

namespace {

template <class Array>
void set_address(Array& array, const DeviceTable& table) {
    array.items = reinterpret_cast<decltype(array.items)>(table.address());
}

std::vector<RasterBound> bounds_of(const std::vector<Box>& boxes, const backend::SceneTables& tables) {
    std::vector<RasterBound> bounds(boxes.size());
    for (std::size_t i = 0; i < bounds.size(); ++i) {
        const shading::Instance& instance = tables.instances[i];
        const std::uint32_t triangles = tables.meshes[instance.mesh].triangle_count;
        bounds[i] = {.low = boxes[i].low,
                     .vertices = boxes[i].empty() ? 0 : 3 * triangles,
                     .high = boxes[i].high,
                     .layers = instance.layers};
    }
    return bounds;
}

}  // namespace

GpuScene::GpuScene(Device& device, TreeCache& cache, Trees trees)
    : device_(device),
      blobs_(device),
      bvh_(device, cache),
      textures_(device),
      materials_(device),
      extras_(device),
      surface_shaders_(device),
      meshes_(device),
      mesh_keys_(device),
      transform_keys_(device),
      motions_(device),
      media_(device),
      instances_(device),
      lights_(device),
      emitters_(device),
      light_nodes_(device),
      cdfs_(device),
      srgb_(device),
      energy_(device),
      scene_(device),
      bounds_(device) {
    if (trees == Trees::Bvh2) bvh2_.emplace(device);
}

Traversal GpuScene::traversal() const {
    if (bvh2_) return Traversal::Bvh2;
    return pool().size() / 16 <= device_.info().texel_elements ? Traversal::Texels : Traversal::Address;
}

BvhPool::Work GpuScene::update(const backend::MeshCatalog& meshes,
                               const backend::MeshCatalog::Result& changes,
                               const backend::SceneTables& tables) {
    backend::SceneTables there = tables;
    backend::set_addresses(there, [&](const scene::BlobPtr& blob) { return blobs_.address_of(blob); });
    BvhPool::Work work;
    if (bvh2_) {
        work.rebuilt = bvh2_->update(meshes, tables.instances);
    } else {
        work = bvh_.update(meshes, changes, tables);
    }
    textures_.update(there.textures);
    materials_.update(there.materials);
    extras_.update(there.extras);
    surface_shaders_.update(there.surface_shaders);
    meshes_.update(there.meshes);
    mesh_keys_.update(there.mesh_keys);
    transform_keys_.update(there.transform_keys);
    motions_.update(there.motions);
    media_.update(there.media);
    instances_.update(there.instances);
    lights_.update(there.lights);
    emitters_.update(there.emitters);
    light_nodes_.update(there.light_nodes);
    cdfs_.update(there.cdfs);
    srgb_.update(std::as_bytes(backend::srgb_values()));
    energy_.update(std::as_bytes(backend::energy_values()));
    set_address(there.scene.textures, textures_);
    set_address(there.scene.materials, materials_);
    set_address(there.scene.extras, extras_);
    set_address(there.scene.surface_shaders, surface_shaders_);
    set_address(there.scene.meshes, meshes_);
    set_address(there.scene.mesh_keys, mesh_keys_);
    set_address(there.scene.transform_keys, transform_keys_);
    set_address(there.scene.motions, motions_);
    set_address(there.scene.media, media_);
    set_address(there.scene.instances, instances_);
    set_address(there.scene.lights, lights_);
    set_address(there.scene.emitters, emitters_);
    set_address(there.scene.light_nodes, light_nodes_);
    set_address(there.scene.cdfs, cdfs_);
    set_address(there.scene.srgb, srgb_);
    set_address(there.scene.energy, energy_);
    scene_.update(std::as_bytes(std::span(&there.scene, 1)));
    if (!bvh2_) bounds_.update(bounds_of(bvh_.boxes(), tables));
    features_ = there.scene.features;
    instance_count_ = there.scene.instance_count;
    blobs_.drop_unused();
    return work;
}

}  // namespace tessera::vulkan
