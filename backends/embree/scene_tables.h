#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "backends/embree/environment.h"
#include "backends/embree/lights.h"
#include "backends/embree/mesh.h"
#include "backends/embree/texture.h"

namespace tessera::embree {

struct MaterialData {
    glm::vec4 base_color{0.8f, 0.8f, 0.8f, 1.0f};
    glm::vec3 emission{0.0f};
    float metallic = 0.0f, roughness = 1.0f, normal_scale = 1.0f, index_of_refraction = 1.5f,
          alpha_cutoff = 0.5f, transmission = 0.0f;
    TextureUse base_color_texture, metallic_roughness_texture, normal_texture, emission_texture;
    scene::AlphaMode alpha_mode = scene::AlphaMode::Opaque;
    bool double_sided = false, unlit = false;
    bool emits() const { return emission.x > 0.0f || emission.y > 0.0f || emission.z > 0.0f; }
};

struct InstanceData {
    const Mesh* mesh = nullptr;
    std::uint32_t material = 0;  // index
    std::uint32_t object = 0;    // the geometry's id
    std::int32_t light = -1;     // index into the light table, if it emits
    glm::mat3 linear{1.0f};      // world from object
    glm::vec3 translation{0.0f};
    glm::mat3 normals{1.0f};  // inverse transpose of `linear`, unnormalised

    glm::vec3 to_world(const glm::vec3& p) const { return linear * p + translation; }
};

// Everything the path tracer looks up, relative to the render origin and ordered by object id: a function of
// the scene's content alone. Rebuilt at each commit; meshes and texels are shared, not copied.
struct SceneTables {
    std::vector<TextureData> textures;
    std::vector<MaterialData> materials;  // 0 = the default grey, 1 = the placeholder's
    std::vector<InstanceData> instances;  // as in Lowered::instances
    LightTable lights;
    Environment environment;
    glm::dvec3 render_origin{0.0};
};

SceneTables make_tables(const scene::Scene& scene, const backend::Lowered& lowered, const MeshStore& meshes,
                        const scene::BlobStore& blobs);

// At a point of an instance's triangle; barycentric weights of the second and third vertex.
glm::vec2 tex_coord_at(const Mesh& mesh, std::uint32_t triangle, const glm::vec2& barycentric);
glm::vec4 base_color_at(const SceneTables& tables, const InstanceData& instance, std::uint32_t triangle,
                        const glm::vec2& barycentric);
float alpha_at(const SceneTables& tables, const InstanceData& instance, std::uint32_t triangle,
               const glm::vec2& barycentric);  // 1 for opaque materials
glm::vec3 emission_at(const SceneTables& tables, const InstanceData& instance, std::uint32_t triangle,
                      const glm::vec2& barycentric);

}  // namespace tessera::embree
