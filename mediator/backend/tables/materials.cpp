// Materials and instances.
#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/bsdf.h"

namespace tessera::backend {

namespace {

constexpr std::uint32_t DefaultMaterial = 0, PlaceholderMaterial = 1;

// The enumerators of the scene are used in the records unchanged.
static_assert(shading::AlphaOpaque == std::uint32_t(scene::AlphaMode::Opaque) &&
              shading::AlphaMask == std::uint32_t(scene::AlphaMode::Mask) &&
              shading::AlphaBlend == std::uint32_t(scene::AlphaMode::Blend));

shading::MaterialExtras make_extras(const scene::Material& m, const Indices& textures) {
    return {
        .specular_color = m.specular_color,
        .specular = m.specular,
        .sheen_color = m.sheen_color,
        .sheen_roughness = m.sheen_roughness,
        .coat = m.clearcoat,
        .coat_roughness = m.clearcoat_roughness,
        .coat_normal_scale = m.clearcoat_normal_scale,
        .anisotropy = m.anisotropy,
        .anisotropy_direction = {std::cos(m.anisotropy_rotation), std::sin(m.anisotropy_rotation)},
        .iridescence = m.iridescence,
        .film_index = m.iridescence_index_of_refraction,
        .film_thickness = {m.iridescence_thickness_minimum, m.iridescence_thickness_maximum},
        .textures = {make_use(m.transmission_texture, textures), make_use(m.specular_texture, textures),
                     make_use(m.specular_color_texture, textures), make_use(m.clearcoat_texture, textures),
                     make_use(m.clearcoat_roughness_texture, textures),
                     make_use(m.sheen_color_texture, textures), make_use(m.sheen_roughness_texture, textures),
                     make_use(m.iridescence_texture, textures),
                     make_use(m.iridescence_thickness_texture, textures)},
        .coat_normal_texture = make_use(m.clearcoat_normal_texture, textures),
        .anisotropy_texture = make_use(m.anisotropy_texture, textures)};
}

// A texture may lower the roughness.
bool may_be_smooth(float roughness, bool has_texture) {
    return has_texture || shading::is_smooth(roughness * roughness);
}

// Whether even rough glass is a delta transmission: between equal indices of refraction, or where there is none.
bool is_delta_at_any_roughness(float index_of_refraction) {
    return index_of_refraction == 0.0f || !shading::is_boundary(index_of_refraction) ||
           !shading::is_boundary(1.0f / index_of_refraction);
}

std::uint32_t thin_bits(const scene::Material& m) {
    if (m.thickness > 0.0f) return 0;
    const bool may_be_clear = m.transmission > 0.0f && !m.unlit &&
                              (may_be_smooth(m.roughness, bool(m.metallic_roughness_texture.texture)) ||
                               is_delta_at_any_roughness(m.index_of_refraction));
    return shading::ThinWalled | (may_be_clear ? shading::ThinClear : 0u);
}

// Whether a material has values that need MaterialExtras.
bool has_extras(const scene::Material& m) {
    return m.specular != 1.0f || m.specular_color != glm::vec3(1.0f) || m.specular_texture.texture ||
           m.specular_color_texture.texture || m.clearcoat > 0.0f || m.sheen_color != glm::vec3(0.0f) ||
           m.anisotropy > 0.0f || m.iridescence > 0.0f ||
           (m.transmission > 0.0f && m.transmission_texture.texture);
}

void add_mesh(SceneTables& tables, const Mesh& mesh) {
    const auto flag = [](const scene::BlobPtr& blob, std::uint32_t bit) { return blob ? bit : 0u; };
    const auto triangles = elements<glm::uvec3>(mesh.triangles);
    tables.arrays.push_back({mesh.positions, mesh.triangles, mesh.normals, mesh.tangents, mesh.colors,
                             mesh.tex_coords, mesh.tex_coords_1});
    tables.meshes.push_back(
        {.positions = {elements<glm::vec3>(mesh.positions).data()},
         .triangles = {triangles.data()},
         .normals = {elements<glm::vec3>(mesh.normals).data()},
         .tangents = {elements<glm::vec4>(mesh.tangents).data()},
         .colors = {elements<glm::vec4>(mesh.colors).data()},
         .tex_coords = {elements<glm::vec2>(mesh.tex_coords).data()},
         .tex_coords_1 = {elements<glm::vec2>(mesh.tex_coords_1).data()},
         .arrays = flag(mesh.normals, shading::MeshNormals) | flag(mesh.tangents, shading::MeshTangents) |
                   flag(mesh.colors, shading::MeshColors) | flag(mesh.tex_coords, shading::MeshTexCoords) |
                   flag(mesh.tex_coords_1, shading::MeshTexCoords1),
         .triangle_count = static_cast<std::uint32_t>(triangles.size())});
    add_mesh_keys(tables, mesh, tables.meshes.back());
}

// Only the direction of a normal counts, so its matrix is scaled into the range of floats, by a power of two to
// stay exact.
glm::mat3 scaled(const glm::dmat3& m) {
    double largest = 0.0;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) largest = std::max(largest, std::fabs(m[column][row]));
    }
    if (!(largest > 0.0) || !std::isfinite(largest)) return glm::mat3(m);
    return glm::mat3(m * std::exp2(-std::floor(std::log2(largest))));
}

// The light of a footprint is that of its mean colour only if nothing else changes with the texture.
std::uint32_t filters_color(const scene::Material& m) {
    const bool has_others =
        m.alpha_mode != scene::AlphaMode::Opaque || m.metallic_roughness_texture.texture ||
        m.normal_texture.texture || m.transmission_texture.texture || m.specular_texture.texture ||
        m.specular_color_texture.texture || m.clearcoat_texture.texture ||
        m.clearcoat_roughness_texture.texture || m.clearcoat_normal_texture.texture ||
        m.sheen_color_texture.texture || m.sheen_roughness_texture.texture || m.iridescence_texture.texture ||
        m.iridescence_thickness_texture.texture || m.anisotropy_texture.texture;
    return m.base_color_texture.texture && !has_others ? 1 : 0;
}

std::uint32_t features_of(const shading::Material& material, const shading::MaterialExtras* extras,
                          const shading::Mesh& mesh) {
    const auto flag = [](bool holds, std::uint32_t feature) { return holds ? feature : 0u; };
    const auto used = [](const shading::TextureUse& use) { return use.texture >= 0; };
    const bool has_tangents = (mesh.arrays & shading::MeshTangents) != 0;
    bool mapped = used(material.normal_texture) && has_tangents;
    bool textured = used(material.base_color_texture) || used(material.metallic_roughness_texture) ||
                    used(material.emission_texture);
    const bool smooth = may_be_smooth(material.roughness, used(material.metallic_roughness_texture));
    const bool rough = !shading::is_smooth(material.roughness * material.roughness);
    const bool glass = material.transmission > 0.0f;
    const bool has_face = material.metallic < 1.0f && material.index_of_refraction != 1.0f;
    bool specular = (material.metallic > 0.0f || glass || has_face) && smooth;
    specular |= glass && is_delta_at_any_roughness(material.index_of_refraction);
    std::uint32_t lobes = flag(glass && rough, shading::FeatureRoughGlass);
    if (extras != nullptr) {
        mapped |= used(extras->coat_normal_texture) && has_tangents;
        textured |= used(extras->anisotropy_texture) || std::ranges::any_of(extras->textures, used);
        specular |=
            extras->coat > 0.0f && (used(extras->textures[shading::ExtrasCoatRoughness]) ||
                                    shading::is_smooth(extras->coat_roughness * extras->coat_roughness));
        lobes |= shading::FeatureExtras | flag(extras->coat > 0.0f, shading::FeatureCoat) |
                 flag(extras->sheen_color != glm::vec3(0.0f), shading::FeatureSheen) |
                 flag(extras->iridescence > 0.0f, shading::FeatureIridescence) |
                 flag(glass && extras->anisotropy > 0.0f, shading::FeatureRoughGlass);
    }
    return lobes | flag(mapped, shading::FeatureNormalMaps) |
           flag(textured || mapped, shading::FeatureTextures) | flag(specular, shading::FeatureSpecular) |
           flag(material.alpha_mode != shading::AlphaOpaque, shading::FeatureAlpha);
}

}  // namespace

shading::TextureUse make_use(const scene::TextureSlot& slot, const Indices& textures) {
    const auto it = textures.find(slot.texture);
    const float c = std::cos(slot.rotation), s = std::sin(slot.rotation);
    // KHR_texture_transform: uv' = offset + rotation x scale x uv, with v down.
    return {.texture = it == textures.end() ? -1 : static_cast<int>(it->second),
            .set = slot.set,
            .row_u = {c * slot.scale.x, s * slot.scale.y},
            .row_v = {-s * slot.scale.x, c * slot.scale.y},
            .offset = slot.offset};
}

shading::Material make_material(const scene::Material& material, const Indices& textures) {
    return {.base_color = material.base_color,
            .emission = material.emission,
            .metallic = material.metallic,
            .roughness = material.roughness,
            .normal_scale = material.normal_scale,
            .index_of_refraction = material.index_of_refraction,
            .alpha_cutoff = material.alpha_cutoff,
            .transmission = material.transmission,
            .base_color_texture = make_use(material.base_color_texture, textures),
            .metallic_roughness_texture = make_use(material.metallic_roughness_texture, textures),
            .normal_texture = make_use(material.normal_texture, textures),
            .emission_texture = make_use(material.emission_texture, textures),
            .alpha_mode = static_cast<std::uint32_t>(material.alpha_mode),
            .double_sided = material.double_sided ? 1u : 0u,
            .unlit = material.unlit ? 1u : 0u,
            .thin = thin_bits(material),
            .extras = -1,
            .surface_shader = -1,
            .filters_color = filters_color(material)};
}

Indices add_materials(SceneTables& tables, const scene::Scene& scene, const Indices& textures) {
    Indices indices;
    const Indices none;
    tables.materials.push_back(make_material({}, none));
    tables.materials.push_back(make_material({.base_color = {1.0f, 0.0f, 1.0f, 1.0f}, .unlit = true}, none));
    for (const auto& [id, object] : scene.objects()) {
        if (const auto* shader = std::get_if<scene::SurfaceShader>(object.get())) {
            indices[id] = static_cast<std::uint32_t>(tables.materials.size());
            tables.materials.push_back(add_shader(tables, *shader, textures));
        }
        const auto* material = std::get_if<scene::Material>(object.get());
        if (material == nullptr) continue;
        indices[id] = static_cast<std::uint32_t>(tables.materials.size());
        tables.materials.push_back(make_material(*material, textures));
        if (!has_extras(*material)) continue;
        tables.materials.back().extras = static_cast<int>(tables.extras.size());
        tables.extras.push_back(make_extras(*material, textures));
    }
    return indices;
}

void set_transform(shading::Instance& instance, const glm::dmat4& world_from_object,
                   const glm::dvec3& origin) {
    // Relative to the origin in double, then rounded once.
    const glm::dmat3 linear(world_from_object);
    instance.linear = glm::mat3(linear);
    instance.translation = glm::vec3(glm::dvec3(world_from_object[3]) - origin);
    // Cofactors instead of the inverse transpose: correct for singular transforms too, and without a division.
    const glm::dmat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                               glm::cross(linear[0], linear[1]));
    const bool mirrors = glm::determinant(linear) < 0.0;
    instance.normals = scaled(mirrors ? -cofactors : cofactors);
    instance.handedness = mirrors ? -1.0f : 1.0f;
}

void add_instances(SceneTables& tables, const FlatScene& flat_scene, const MeshCatalog& meshes,
                   const Indices& materials) {
    ObjectId last;
    for (const Instance& source : flat_scene.instances) {  // sorted by geometry
        const Mesh& mesh = *meshes.find(source.geometry);
        if (tables.meshes.empty() || source.geometry != last) add_mesh(tables, mesh);
        last = source.geometry;
        const auto material = materials.find(mesh.source.material);
        shading::Instance instance{
            .mesh = static_cast<std::uint32_t>(tables.meshes.size() - 1),
            .material = material == materials.end() ? DefaultMaterial : material->second,
            .object = static_cast<std::uint32_t>(source.geometry.value),
            .light = -1,
            .layers = source.layers,
            .medium = -1};
        if (mesh.placeholder) instance.material = PlaceholderMaterial;
        set_transform(instance, source.world_from_object, tables.render_origin);
        instance.motion = add_motion(tables, source.world_from_object, source.motion);
        const shading::Material& record = tables.materials[instance.material];
        const bool is_thin_wall = (record.thin & shading::ThinClear) != 0;
        if (is_thin_wall) tables.scene.features |= shading::FeatureThinGlass;
        const bool is_unlit = record.unlit != 0;
        if (is_unlit) tables.scene.features |= shading::FeatureAlpha;
        instance.alpha_tested =
            record.alpha_mode != shading::AlphaOpaque || is_thin_wall || is_unlit ? 1u : 0u;
        tables.scene.features |=
            record.surface_shader >= 0
                ? features_of(record, tables.surface_shaders[static_cast<std::size_t>(record.surface_shader)])
                : features_of(
                      record,
                      record.extras >= 0 ? &tables.extras[static_cast<std::size_t>(record.extras)] : nullptr,
                      tables.meshes.back());
        tables.instances.push_back(instance);
    }
    tables.scene.instance_count = static_cast<std::uint32_t>(tables.instances.size());
}

}  // namespace tessera::backend
