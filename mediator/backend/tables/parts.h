#pragma once

#include <map>
#include <vector>

#include "mediator/backend/tables/light_tree.h"
#include "mediator/backend/tables/tables.h"

// Stages of make_tables, in this order. Each uses the tables filled by the previous ones.
namespace tessera::backend {

using Indices = std::map<ObjectId, std::uint32_t>;  // index of each object in its table

// Only textures that a placed geometry or the background uses; others are not loaded.
Indices add_textures(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene,
                     const MeshCatalog& meshes, const scene::BlobStore& blobs, MipmapCache& mipmaps);
shading::TextureUse make_use(const scene::TextureSlot& slot, const Indices& textures);
// Glass with a volume (not thin-walled), which refracts.
bool is_solid_glass(const shading::Material& material);
shading::Material make_material(const scene::Material& material, const Indices& textures);

// Appends the parameters specific to CommonSurfaceShader, and returns the common material.
shading::Material add_shader(SceneTables& tables, const scene::SurfaceShader& shader,
                             const Indices& textures);
std::uint32_t features_of(const shading::Material& material, const shading::SurfaceShaderParams& shader);

Indices add_materials(SceneTables& tables, const scene::Scene& scene, const Indices& textures);
void add_instances(SceneTables& tables, const FlatScene& flat_scene, const MeshCatalog& meshes,
                   const Indices& materials);

// Sets the transform of an instance, relative to the render origin.
void set_transform(shading::Instance& instance, const glm::dmat4& world_from_object,
                   const glm::dvec3& origin);

// Appends motion keys, relative to the render origin; returns the index of the motion, -1 without keys.
int add_motion(SceneTables& tables, const glm::dmat4& beginning, std::span<const glm::dmat4> steps);

// The transform of an instance at each motion key.
std::vector<shading::Affine3x4> transform_keys_of(const SceneTables& tables,
                                                  const shading::Instance& instance);

// Appends the motion keys of a deforming mesh.
void add_mesh_keys(SceneTables& tables, const Mesh& source, shading::Mesh& mesh);

// Marks instances with a shadow catcher material: they block only rays with the matching mask, and do not emit.
void mark_shadow_catchers(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene,
                          const MeshCatalog& meshes);

// Whether solid glass objects may be nested: their bounds overlap.
bool has_nested_glass(const SceneTables& tables, const FlatScene& flat_scene, const MeshCatalog& meshes);

// The media of instances, unless none of them is visible.
void add_media(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene,
               const MeshCatalog& meshes, const Indices& textures);

void add_environment(SceneTables& tables, const scene::Scene& scene, const Indices& textures);

// Emitters in the order of their lights, and leaves of those with power.
struct EmitterList {
    std::vector<shading::Emitter> emitters;
    std::vector<LightLeaf> leaves;
};

// Sets the light index of emissive instances.
void add_mesh_lights(SceneTables& tables, EmitterList& list);

// All lights, those of meshes included. Needs the environment.
void add_lights(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene);

// Appends the CDF of the weights to the tables, normalised to end at 1 (uniform if all weights are 0), and returns
// the index of its first entry.
std::uint32_t add_cdf(SceneTables& tables, const std::vector<double>& weights);

}  // namespace tessera::backend
