#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "mediator/backend/tables/meshes.h"
#include "mediator/backend/tables/pyramids.h"
#include "mediator/shading/layout.h"

namespace tessera::backend {

// Relative to the render origin; low > high: nothing.
struct Bounds {
    glm::dvec3 low{std::numeric_limits<double>::infinity()};
    glm::dvec3 high{-std::numeric_limits<double>::infinity()};
};

// Everything that rays are shaded with, relative to the render origin and ordered by object id: a function of
// the scene's content alone, the same for all back-ends. Vertices and texels stay in their blobs.
struct SceneTables {
    std::vector<shading::Texture> textures;       // that are used
    std::vector<shading::Material> materials;     // 0 = the default grey, 1 = the placeholder's
    std::vector<shading::MaterialExtras> extras;  // of those that have any
    std::vector<shading::Shader> shaders;         // of the materials that are CommonSurfaceShaders
    std::vector<shading::Mesh> meshes;            // of the geometries that are placed
    std::vector<shading::MeshStep> mesh_steps;    // of meshes that bend, the beginning's and each after it
    std::vector<shading::Place> places;           // of what moves, likewise
    std::vector<shading::Motion> motions;         // of instances, then of lights
    std::vector<shading::Body> bodies;            // of the geometries that are filled with something
    std::vector<shading::Instance> instances;     // as in Lowered::instances
    // In the tree: mesh lights by instance, placed lights by (id, path); distant: placed lights likewise, the
    // sky.
    std::vector<shading::LightSource> lights;
    std::vector<shading::Emitter> emitters;       // by light
    std::vector<shading::LightNode> light_nodes;  // of the emitters that shine
    std::vector<float> sums;                      // cumulative; each ends at 1
    shading::Scene scene{};                       // all of it but the addresses of the tables
    glm::dvec3 render_origin{0.0};
    std::vector<std::uint32_t> layers;  // each mask of instances and lights once
    Bounds bounds;                      // of all that can be hit

    // What the records' addresses point into: of each texture, of the environment's map and of each mesh.
    std::vector<scene::BlobPtr> texels, levels;
    scene::BlobPtr environment_texels;
    struct Arrays {
        scene::BlobPtr positions, triangles, normals, tangents, colors, tex_coords, tex_coords_1;
    };
    std::vector<Arrays> arrays;
    struct StepArrays {
        scene::BlobPtr positions, normals;
    };
    std::vector<StepArrays> step_arrays;  // of each mesh step
};

// The light tree or one of the distant lights is chosen in proportion to its power, a tenth uniformly, so
// that a wrong estimate costs noise, never light. Addresses are the host's.
SceneTables make_tables(const scene::Scene& scene, const Lowered& lowered, const MeshCatalog& meshes,
                        const scene::BlobStore& blobs, TexturePyramids& pyramids);

// What update_tables has done: given moved instances their places, or made all tables anew.
enum class TablesStep { Moved, Made };

// The same as the tables made anew, from those of before the edit.
TablesStep update_tables(SceneTables& tables, const scene::Scene& scene, const Lowered& lowered,
                         const MeshCatalog& meshes, const scene::BlobStore& blobs, TexturePyramids& pyramids,
                         const SceneDelta& delta);

// The scene on the host: addresses of the tables' own memory, valid while they are neither changed nor moved.
shading::Scene on_host(const SceneTables& tables);

// The scene's features and the view's.
std::uint32_t features_for(const SceneTables& tables, const shading::View& view);

// 256 linear values, for Scene::srgb.
std::span<const float> srgb_values();

// For Scene::energy: what lobes reflect of light from everywhere (shading/energy.h).
std::span<const float> energy_values();

// Where a blob lies for whoever reads the records, on a device for instance. Never asked for null.
using BlobAddress = std::function<std::uint64_t(const scene::BlobPtr& blob)>;
void set_addresses(SceneTables& tables, const BlobAddress& address_of);

}  // namespace tessera::backend
