#pragma once

#include <map>
#include <vector>

#include "mediator/backend/tables/light_tree.h"
#include "mediator/backend/tables/tables.h"

// Steps of make_tables, in this order. Each reads what the former have put into the tables.
namespace tessera::backend {

using Indices = std::map<ObjectId, std::uint32_t>;  // of objects in their table

// Those alone that something placed, or the background, refers to: no others are in anybody's memory.
Indices add_textures(SceneTables& tables, const scene::Scene& scene, const Lowered& lowered,
                     const MeshCatalog& meshes, const scene::BlobStore& blobs, TexturePyramids& pyramids);
shading::TextureUse make_use(const scene::TextureSlot& slot, const Indices& textures);
// Glass that is a body, with an index of refraction of its own.
bool is_solid_glass(const shading::Material& material);
shading::Material make_material(const scene::Material& material, const Indices& textures);

// Appends what only CommonSurfaceShader has, and returns the rest.
shading::Material add_shader(SceneTables& tables, const scene::SurfaceShader& shader,
                             const Indices& textures);
std::uint32_t features_of(const shading::Material& material, const shading::Shader& shader);

Indices add_materials(SceneTables& tables, const scene::Scene& scene, const Indices& textures);
void add_instances(SceneTables& tables, const Lowered& lowered, const MeshCatalog& meshes,
                   const Indices& materials);

// Gives an instance its place, relative to the render origin.
void place(shading::Instance& instance, const glm::dmat4& world_from_object, const glm::dvec3& origin);

// Of an instance, at any time.
Bounds bounds_of(const SceneTables& tables, const shading::Instance& instance, const Mesh& mesh);
// Of all that can be hit, at any time; how far that reaches, for the power of what shines on all of it.
Bounds bounds_of(const SceneTables& tables, const Lowered& lowered, const MeshCatalog& meshes);
double radius_of(const Bounds& bounds);

// Adds the way of what goes through these places, relative to the render origin; -1 where it stands still.
int add_motion(SceneTables& tables, const glm::dmat4& beginning, std::span<const glm::dmat4> steps);

// Where an instance is at the beginning and at each step after it.
std::vector<shading::Place> places_of(const SceneTables& tables, const shading::Instance& instance);

// Makes a mesh one that bends.
void add_mesh_steps(SceneTables& tables, const Mesh& source, shading::Mesh& mesh);

// Instances of a material that catches shadows: they stop rays where their mask says so, and do not shine.
void mark_shadow_catchers(SceneTables& tables, const scene::Scene& scene, const Lowered& lowered,
                          const MeshCatalog& meshes);

// Whether bodies of glass may lie in each other: their bounds overlap.
bool glass_nests(const SceneTables& tables, const Lowered& lowered, const MeshCatalog& meshes);

// What instances are filled with, if anything placed is filled with what can be seen.
void add_bodies(SceneTables& tables, const scene::Scene& scene, const Lowered& lowered,
                const MeshCatalog& meshes, const Indices& textures);

// Radiance over the sphere in the mean, as luminance; 0: there is no sky.
double add_environment(SceneTables& tables, const scene::Scene& scene, const Indices& textures);

// Emitters in the order of their lights, and leaves of those that shine.
struct EmitterList {
    std::vector<shading::Emitter> emitters;
    std::vector<LightLeaf> leaves;
};

// Instances that emit get their light's index.
void add_mesh_lights(SceneTables& tables, EmitterList& list);

// All lights, those of meshes included.
void add_lights(SceneTables& tables, const scene::Scene& scene, const Lowered& lowered,
                const MeshCatalog& meshes, double sky_luminance);

// Appends cumulative sums of the weights to the tables' sums, normalised to end at 1 (evenly spread where all
// weights are 0), and returns the index of the first.
std::uint32_t add_sums(SceneTables& tables, const std::vector<double>& weights);

}  // namespace tessera::backend
