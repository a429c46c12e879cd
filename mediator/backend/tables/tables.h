#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "mediator/backend/tables/meshes.h"
#include "mediator/backend/tables/mipmap_cache.h"
#include "mediator/shading/layout.h"

namespace tessera::backend {

// All scene data for shading, relative to the render origin and ordered by object id: a function of the scene's
// content alone, the same for all back-ends. Vertices and texels stay in their blobs.
// Of the environment light, over the sphere.
struct SkyMeans {
    double luminance = 0.0;
    double excess = 0.0;  // of what samples of the map are to find: the luminance above its mean
};

struct SceneTables {
    std::vector<shading::Texture> textures;                     // those in use
    std::vector<shading::Material> materials;                   // 0 = the default grey, 1 = the placeholder's
    std::vector<shading::MaterialExtras> extras;                // of materials that have them
    std::vector<shading::SurfaceShaderParams> surface_shaders;  // of the CommonSurfaceShaders
    std::vector<shading::Mesh> meshes;                          // of the geometries that are placed
    std::vector<shading::MeshKey> mesh_keys;                    // of deforming meshes
    std::vector<shading::Affine3x4> transform_keys;             // of moving instances and lights
    std::vector<shading::Motion> motions;                       // of instances, then of lights
    std::vector<shading::Medium> media;                         // of the geometries with an interior medium
    std::vector<shading::Instance> instances;                   // as in FlatScene::instances
    // First those of the tree: mesh lights by instance, placed lights by (id, path). Then infinite lights: directional
    // ones by (id, path), the environment.
    std::vector<shading::LightSource> lights;
    std::vector<shading::Emitter> emitters;       // by light
    std::vector<shading::LightNode> light_nodes;  // of the emitters with power
    std::vector<float> cdfs;                      // each ends at 1
    shading::Scene scene{};                       // without the addresses of the tables
    glm::dvec3 render_origin{0.0};
    SkyMeans sky;
    std::vector<std::uint32_t> layers;  // each layer mask of instances and lights, once

    // The blobs that the addresses in the records point to: of each texture, the environment map and each mesh.
    std::vector<scene::BlobPtr> texels, levels;
    scene::BlobPtr environment_texels;
    struct Arrays {
        scene::BlobPtr positions, triangles, normals, tangents, colors, tex_coords, tex_coords_1;
    };
    std::vector<Arrays> arrays;
    struct KeyArrays {
        scene::BlobPtr positions, normals;
    };
    std::vector<KeyArrays> key_arrays;  // of each of mesh_keys
};

// Addresses are those of the host.
SceneTables make_tables(const scene::Scene& scene, const FlatScene& flat_scene, const MeshCatalog& meshes,
                        const scene::BlobStore& blobs, MipmapCache& mipmaps);

// Whether update_tables updated the transforms of moved instances, or rebuilt all tables.
enum class TablesUpdate { Moved, Rebuilt };

// Updates the tables after an edit. The result equals that of make_tables.
TablesUpdate update_tables(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene,
                           const MeshCatalog& meshes, const scene::BlobStore& blobs, MipmapCache& mipmaps,
                           const SceneDelta& delta);

// The scene on the host: addresses of the tables' own memory, valid while they are neither changed nor moved.
shading::Scene on_host(const SceneTables& tables);

// The scene's features and the view's.
std::uint32_t features_for(const SceneTables& tables, const shading::View& view);

// 256 linear values, for Scene::srgb.
std::span<const float> srgb_values();

// For Scene::energy: directional albedos of the lobes (shading/energy.h).
std::span<const float> energy_values();

// The address of a blob for the reader of the records, for instance on a device. Never called with null.
using BlobAddress = std::function<std::uint64_t(const scene::BlobPtr& blob)>;
void set_addresses(SceneTables& tables, const BlobAddress& address_of);

}  // namespace tessera::backend
