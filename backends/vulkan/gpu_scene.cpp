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
      shaders_(device),
      meshes_(device),
      mesh_steps_(device),
      places_(device),
      motions_(device),
      bodies_(device),
      instances_(device),
      lights_(device),
      emitters_(device),
      light_nodes_(device),
      sums_(device),
      srgb_(device),
      energy_(device),
      scene_(device),
      bounds_(device) {
    if (trees == Trees::Plain) plain_.emplace(device);
}

Traversal GpuScene::traversal() const {
    if (plain_) return Traversal::Plain;
    return pool().size() / 16 <= device_.info().texel_elements ? Traversal::Texels : Traversal::Address;
}

BvhPool::Work GpuScene::update(const backend::MeshCatalog& meshes,
                               const backend::MeshCatalog::Result& changes,
                               const backend::SceneTables& tables) {
    backend::SceneTables there = tables;
    backend::set_addresses(there, [&](const scene::BlobPtr& blob) { return blobs_.address_of(blob); });
    BvhPool::Work work;
    if (plain_) {
        work.rebuilt = plain_->update(meshes, tables.instances);
    } else {
        work = bvh_.update(meshes, changes, tables);
    }
    textures_.update(there.textures);
    materials_.update(there.materials);
    extras_.update(there.extras);
    shaders_.update(there.shaders);
    meshes_.update(there.meshes);
    mesh_steps_.update(there.mesh_steps);
    places_.update(there.places);
    motions_.update(there.motions);
    bodies_.update(there.bodies);
    instances_.update(there.instances);
    lights_.update(there.lights);
    emitters_.update(there.emitters);
    light_nodes_.update(there.light_nodes);
    sums_.update(there.sums);
    srgb_.update(std::as_bytes(backend::srgb_values()));
    energy_.update(std::as_bytes(backend::energy_values()));
    set_address(there.scene.textures, textures_);
    set_address(there.scene.materials, materials_);
    set_address(there.scene.extras, extras_);
    set_address(there.scene.shaders, shaders_);
    set_address(there.scene.meshes, meshes_);
    set_address(there.scene.mesh_steps, mesh_steps_);
    set_address(there.scene.places, places_);
    set_address(there.scene.motions, motions_);
    set_address(there.scene.bodies, bodies_);
    set_address(there.scene.instances, instances_);
    set_address(there.scene.lights, lights_);
    set_address(there.scene.emitters, emitters_);
    set_address(there.scene.light_nodes, light_nodes_);
    set_address(there.scene.sums, sums_);
    set_address(there.scene.srgb, srgb_);
    set_address(there.scene.energy, energy_);
    scene_.update(std::as_bytes(std::span(&there.scene, 1)));
    if (!plain_) bounds_.update(bounds_of(bvh_.boxes(), tables));
    features_ = there.scene.features;
    instance_count_ = there.scene.instance_count;
    blobs_.drop_unused();
    return work;
}

}  // namespace tessera::vulkan
