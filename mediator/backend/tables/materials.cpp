// Textures, materials and instances.
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/bsdf.h"

namespace tessera::backend {

namespace {

constexpr std::uint32_t DefaultMaterial = 0, PlaceholderMaterial = 1;

// A record holds the scene's own numbers.
static_assert(shading::TexelRgba8 == std::uint32_t(scene::TexelFormat::Rgba8) &&
              shading::TexelRgba8Srgb == std::uint32_t(scene::TexelFormat::Rgba8Srgb) &&
              shading::TexelRgbFloat == std::uint32_t(scene::TexelFormat::RgbFloat));
static_assert(shading::WrapRepeat == std::uint32_t(scene::Wrap::Repeat) &&
              shading::WrapMirror == std::uint32_t(scene::Wrap::Mirror) &&
              shading::WrapClamp == std::uint32_t(scene::Wrap::Clamp));
static_assert(shading::TextureLinear == std::uint32_t(scene::TextureFilter::Linear) &&
              shading::TextureNearest == std::uint32_t(scene::TextureFilter::Nearest));
static_assert(shading::AlphaOpaque == std::uint32_t(scene::AlphaMode::Opaque) &&
              shading::AlphaMask == std::uint32_t(scene::AlphaMode::Mask) &&
              shading::AlphaBlend == std::uint32_t(scene::AlphaMode::Blend));

shading::TextureUse make_use(const scene::TextureSlot& slot, const Indices& textures) {
    const auto place = textures.find(slot.texture);
    const float c = std::cos(slot.rotation), s = std::sin(slot.rotation);
    // KHR_texture_transform: uv' = offset + rotation x scale x uv, with v down.
    return {.texture = place == textures.end() ? -1 : static_cast<int>(place->second),
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
            .unlit = material.unlit ? 1u : 0u};
}

// Whether all texels are there; else validation has told of it.
bool is_whole(const scene::Texture& texture, const scene::BlobPtr& texels) {
    const std::uint64_t texel = texture.format == scene::TexelFormat::RgbFloat ? 12 : 4;
    return texels && texture.width > 0 && texture.height > 0 &&
           texels->bytes().size() / texel / texture.width >= texture.height;
}

void add_mesh(SceneTables& tables, const Mesh& mesh) {
    const auto flag = [](const scene::BlobPtr& blob, std::uint32_t bit) { return blob ? bit : 0u; };
    const auto triangles = elements<glm::uvec3>(mesh.triangles);
    tables.arrays.push_back(
        {mesh.positions, mesh.triangles, mesh.normals, mesh.tangents, mesh.colors, mesh.tex_coords});
    tables.meshes.push_back(
        {.positions = {elements<glm::vec3>(mesh.positions).data()},
         .triangles = {triangles.data()},
         .normals = {elements<glm::vec3>(mesh.normals).data()},
         .tangents = {elements<glm::vec4>(mesh.tangents).data()},
         .colors = {elements<glm::vec4>(mesh.colors).data()},
         .tex_coords = {elements<glm::vec2>(mesh.tex_coords).data()},
         .arrays = flag(mesh.normals, shading::MeshNormals) | flag(mesh.tangents, shading::MeshTangents) |
                   flag(mesh.colors, shading::MeshColors) | flag(mesh.tex_coords, shading::MeshTexCoords),
         .triangle_count = static_cast<std::uint32_t>(triangles.size())});
}

// Only the direction of a normal counts, so its matrix may be scaled into the range of floats; by a power of
// two, which costs no bits.
glm::mat3 scaled(const glm::dmat3& m) {
    double largest = 0.0;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) largest = std::max(largest, std::fabs(m[column][row]));
    }
    if (!(largest > 0.0) || !std::isfinite(largest)) return glm::mat3(m);
    return glm::mat3(m * std::exp2(-std::floor(std::log2(largest))));
}

std::uint32_t features_of(const shading::Material& material, const shading::Mesh& mesh) {
    const bool mapped = material.normal_texture.texture >= 0 && (mesh.arrays & shading::MeshTangents) != 0;
    const bool textured = material.base_color_texture.texture >= 0 ||
                          material.metallic_roughness_texture.texture >= 0 ||
                          material.emission_texture.texture >= 0 || mapped;
    // A mirror is a metal without roughness, which a texture may take away.
    const bool smooth = material.metallic_roughness_texture.texture >= 0 ||
                        material.roughness * material.roughness <= shading::MinAlpha;
    const bool specular = material.transmission > 0.0f || (material.metallic > 0.0f && smooth);
    return (mapped ? shading::FeatureNormalMaps : 0u) | (textured ? shading::FeatureTextures : 0u) |
           (specular ? shading::FeatureSpecular : 0u) |
           (material.alpha_mode != shading::AlphaOpaque ? shading::FeatureAlpha : 0u);
}

}  // namespace

Indices add_textures(SceneTables& tables, const scene::Scene& scene, const scene::BlobStore& blobs) {
    Indices indices;
    for (const auto& [id, object] : scene.objects()) {
        const auto* texture = std::get_if<scene::Texture>(object.get());
        if (texture == nullptr) continue;
        scene::BlobPtr texels = blobs.find(texture->texels.hash);
        if (!is_whole(*texture, texels)) continue;
        indices[id] = static_cast<std::uint32_t>(tables.textures.size());
        tables.textures.push_back({.texels = {texels->as<std::uint32_t>().data()},
                                   .width = texture->width,
                                   .height = texture->height,
                                   .format = static_cast<std::uint32_t>(texture->format),
                                   .wrap_s = static_cast<std::uint32_t>(texture->wrap_s),
                                   .wrap_t = static_cast<std::uint32_t>(texture->wrap_t),
                                   .texture_filter = static_cast<std::uint32_t>(texture->filter)});
        tables.texels.push_back(std::move(texels));
    }
    return indices;
}

Indices add_materials(SceneTables& tables, const scene::Scene& scene, const Indices& textures) {
    Indices indices;
    const Indices none;
    tables.materials.push_back(make_material({}, none));
    tables.materials.push_back(make_material({.base_color = {1.0f, 0.0f, 1.0f, 1.0f}, .unlit = true}, none));
    for (const auto& [id, object] : scene.objects()) {
        const auto* material = std::get_if<scene::Material>(object.get());
        if (material == nullptr) continue;
        indices[id] = static_cast<std::uint32_t>(tables.materials.size());
        tables.materials.push_back(make_material(*material, textures));
    }
    return indices;
}

void add_instances(SceneTables& tables, const Lowered& lowered, const MeshCatalog& meshes,
                   const Indices& materials) {
    ObjectId last;
    for (const Instance& source : lowered.instances) {  // those of a geometry stand together
        const Mesh& mesh = *meshes.find(source.geometry);
        if (tables.meshes.empty() || source.geometry != last) add_mesh(tables, mesh);
        last = source.geometry;
        const auto material = materials.find(mesh.source.material);
        shading::Instance instance{
            .mesh = static_cast<std::uint32_t>(tables.meshes.size() - 1),
            .material = material == materials.end() ? DefaultMaterial : material->second,
            .object = static_cast<std::uint32_t>(source.geometry.value),
            .light = -1,
            .layers = source.layers};
        if (mesh.placeholder) instance.material = PlaceholderMaterial;
        // Relative to the origin in double, then rounded once.
        const glm::dmat3 linear(source.world_from_object);
        instance.linear = glm::mat3(linear);
        instance.translation = glm::vec3(glm::dvec3(source.world_from_object[3]) - tables.render_origin);
        // Cofactors instead of the inverse: right for flattened instances too, and no division.
        const glm::dmat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                                   glm::cross(linear[0], linear[1]));
        instance.normals = scaled(glm::determinant(linear) < 0.0 ? -cofactors : cofactors);
        const shading::Material& look = tables.materials[instance.material];
        instance.alpha_tested = look.alpha_mode != shading::AlphaOpaque ? 1u : 0u;
        tables.scene.features |= features_of(look, tables.meshes.back());
        tables.instances.push_back(instance);
    }
    tables.scene.instance_count = static_cast<std::uint32_t>(tables.instances.size());
}

}  // namespace tessera::backend
