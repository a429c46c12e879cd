#include "backends/embree/scene_tables.h"

#include <limits>
#include <map>

#include "backends/embree/light_builder.h"

namespace tessera::embree {

namespace {

constexpr std::uint32_t DefaultMaterial = 0, PlaceholderMaterial = 1;

using Indices = std::map<ObjectId, std::uint32_t>;

Indices add_textures(SceneTables& tables, const scene::Scene& scene, const scene::BlobStore& blobs) {
    Indices indices;
    for (const auto& [id, object] : scene.objects()) {
        const auto* texture = std::get_if<scene::Texture>(object.get());
        if (texture == nullptr) continue;
        scene::BlobPtr texels = blobs.find(texture->texels.hash);
        if (!texels || texels->bytes().size() != texture->texels.byte_size) continue;  // told by validation
        indices[id] = static_cast<std::uint32_t>(tables.textures.size());
        tables.textures.push_back({std::move(texels), texture->width, texture->height, texture->format,
                                   texture->wrap_s, texture->wrap_t, texture->filter});
    }
    return indices;
}

MaterialData make_material(const scene::Material& material, const Indices& textures) {
    const auto use = [&](const scene::TextureSlot& slot) {
        const auto place = textures.find(slot.texture);
        return make_use(slot, place == textures.end() ? -1 : static_cast<int>(place->second));
    };
    return {.base_color = material.base_color,
            .emission = material.emission,
            .metallic = material.metallic,
            .roughness = material.roughness,
            .normal_scale = material.normal_scale,
            .index_of_refraction = material.index_of_refraction,
            .alpha_cutoff = material.alpha_cutoff,
            .transmission = material.transmission,
            .base_color_texture = use(material.base_color_texture),
            .metallic_roughness_texture = use(material.metallic_roughness_texture),
            .normal_texture = use(material.normal_texture),
            .emission_texture = use(material.emission_texture),
            .alpha_mode = material.alpha_mode,
            .double_sided = material.double_sided,
            .unlit = material.unlit};
}

Indices add_materials(SceneTables& tables, const scene::Scene& scene, const Indices& textures) {
    Indices indices;
    tables.materials.resize(2);
    tables.materials[PlaceholderMaterial] = {.base_color = {1.0f, 0.0f, 1.0f, 1.0f}, .unlit = true};
    for (const auto& [id, object] : scene.objects()) {
        const auto* material = std::get_if<scene::Material>(object.get());
        if (material == nullptr) continue;
        indices[id] = static_cast<std::uint32_t>(tables.materials.size());
        tables.materials.push_back(make_material(*material, textures));
    }
    return indices;
}

void add_instances(SceneTables& tables, const backend::Lowered& lowered, const MeshStore& meshes,
                   const Indices& materials) {
    for (const backend::Instance& source : lowered.instances) {
        const Mesh* mesh = meshes.find(source.geometry);
        InstanceData instance{.mesh = mesh, .object = static_cast<std::uint32_t>(source.geometry.value)};
        const auto material = materials.find(mesh->source.material);
        instance.material = material == materials.end() ? DefaultMaterial : material->second;
        if (mesh->placeholder) instance.material = PlaceholderMaterial;
        // Relative to the origin in double, then rounded once.
        const glm::dmat3 linear(source.world_from_object);
        instance.linear = glm::mat3(linear);
        instance.translation = glm::vec3(glm::dvec3(source.world_from_object[3]) - tables.render_origin);
        // Cofactors instead of the inverse: right for flattened instances too, and no division.
        instance.normals =
            glm::mat3(glm::dmat3(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                                 glm::cross(linear[0], linear[1])));
        if (glm::determinant(linear) < 0.0) instance.normals = -1.0f * instance.normals;
        tables.instances.push_back(instance);
    }
}

double radius_of(const SceneTables& tables) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const InstanceData& instance : tables.instances) {
        RTCBounds bounds;
        rtcGetSceneBounds(instance.mesh->scene.get(), &bounds);
        if (!(bounds.lower_x <= bounds.upper_x)) continue;
        for (unsigned i = 0; i < 8; ++i) {
            const glm::dvec3 corner = instance.to_world({(i & 1u) ? bounds.lower_x : bounds.upper_x,
                                                         (i & 2u) ? bounds.lower_y : bounds.upper_y,
                                                         (i & 4u) ? bounds.lower_z : bounds.upper_z});
            low = glm::min(low, corner);
            high = glm::max(high, corner);
        }
    }
    const double radius = 0.5 * glm::length(high - low);
    return radius > 0.0 && radius < std::numeric_limits<double>::infinity() ? radius : 1.0;
}

PlacedLights place_lights(const SceneTables& tables, const scene::Scene& scene,
                          const backend::Lowered& lowered) {
    PlacedLights placed;
    placed.scene_radius = radius_of(tables);
    for (const backend::PlacedLight& light : lowered.lights) {
        const glm::dvec3 shines = glm::dmat3(light.world_from_light) * glm::dvec3(0.0, 0.0, -1.0);
        const double length = glm::length(shines);
        if (!(length > 0.0)) continue;  // flattened: it has no direction
        placed.items.push_back({scene.find_as<scene::Light>(light.light),
                                glm::vec3(glm::dvec3(light.world_from_light[3]) - tables.render_origin),
                                glm::vec3(shines / length)});
    }
    return placed;
}

template <class T>
T interpolate(std::span<const T> values, const glm::uvec3& corners, const glm::vec2& b) {
    return values[corners.x] * (1.0f - b.x - b.y) + values[corners.y] * b.x + values[corners.z] * b.y;
}

}  // namespace

SceneTables make_tables(const scene::Scene& scene, const backend::Lowered& lowered, const MeshStore& meshes,
                        const scene::BlobStore& blobs) {
    SceneTables tables;
    const auto* root = scene.find_as<scene::Root>(scene::RootId);
    if (root != nullptr) tables.render_origin = root->render_origin;
    const Indices textures = add_textures(tables, scene, blobs);
    const Indices materials = add_materials(tables, scene, textures);
    add_instances(tables, lowered, meshes, materials);
    if (const auto* background = root ? scene.find_as<scene::Background>(root->background) : nullptr) {
        const auto map = textures.find(background->environment);
        tables.environment =
            Environment(*background, map == textures.end() ? nullptr : &tables.textures[map->second]);
    }
    tables.lights = make_lights(tables, place_lights(tables, scene, lowered));
    return tables;
}

glm::vec2 tex_coord_at(const Mesh& mesh, std::uint32_t triangle, const glm::vec2& barycentric) {
    if (mesh.tex_coords.empty()) return glm::vec2(0.0f);
    return interpolate(mesh.tex_coords, mesh.triangles[triangle], barycentric);
}

glm::vec4 base_color_at(const SceneTables& tables, const InstanceData& instance, std::uint32_t triangle,
                        const glm::vec2& barycentric) {
    const MaterialData& material = tables.materials[instance.material];
    glm::vec4 color = material.base_color;
    if (material.base_color_texture.texture >= 0) {
        color *= lookup(tables.textures, material.base_color_texture,
                        tex_coord_at(*instance.mesh, triangle, barycentric));
    }
    if (!instance.mesh->colors.empty()) {
        color *= interpolate(instance.mesh->colors, instance.mesh->triangles[triangle], barycentric);
    }
    return color;
}

float alpha_at(const SceneTables& tables, const InstanceData& instance, std::uint32_t triangle,
               const glm::vec2& barycentric) {
    const MaterialData& material = tables.materials[instance.material];
    if (material.alpha_mode == scene::AlphaMode::Opaque) return 1.0f;
    return base_color_at(tables, instance, triangle, barycentric).a;
}

glm::vec3 emission_at(const SceneTables& tables, const InstanceData& instance, std::uint32_t triangle,
                      const glm::vec2& barycentric) {
    const MaterialData& material = tables.materials[instance.material];
    if (material.emission_texture.texture < 0) return material.emission;
    return material.emission * glm::vec3(lookup(tables.textures, material.emission_texture,
                                                tex_coord_at(*instance.mesh, triangle, barycentric)));
}

}  // namespace tessera::embree
