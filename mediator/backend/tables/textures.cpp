#include <set>
#include <type_traits>

#include "mediator/backend/tables/parts.h"
#include "mediator/scene/fields.h"

namespace tessera::backend {

namespace {

// The enumerators of the scene are used in the records unchanged.
static_assert(shading::TexelRgba8 == std::uint32_t(scene::TexelFormat::Rgba8) &&
              shading::TexelRgba8Srgb == std::uint32_t(scene::TexelFormat::Rgba8Srgb) &&
              shading::TexelRgbFloat == std::uint32_t(scene::TexelFormat::RgbFloat));
static_assert(shading::WrapRepeat == std::uint32_t(scene::Wrap::Repeat) &&
              shading::WrapMirror == std::uint32_t(scene::Wrap::Mirror) &&
              shading::WrapClamp == std::uint32_t(scene::Wrap::Clamp));
static_assert(shading::TextureLinear == std::uint32_t(scene::TextureFilter::Linear) &&
              shading::TextureNearest == std::uint32_t(scene::TextureFilter::Nearest));

// Whether all texels are there; validation has reported it otherwise.
bool is_whole(const scene::Texture& texture, const scene::BlobPtr& texels) {
    const std::uint64_t texel = texture.format == scene::TexelFormat::RgbFloat ? 12 : 4;
    return texels && texture.width > 0 && texture.height > 0 && texture.depth > 0 &&
           texels->bytes().size() / texel / texture.width / texture.height >= texture.depth;
}

struct Used {
    std::set<ObjectId> textures;
    std::set<ObjectId> filtered;  // those that need mip maps
};

// Emission and media are looked up without filtering; `ambient` is not used.
template <class T>
void note_textures(const T& material, Used& used) {
    scene::for_each_field<T>([&](unsigned, auto member) {
        if constexpr (std::is_same_v<decltype(member), scene::TextureSlot T::*>) {
            if constexpr (std::is_same_v<T, scene::SurfaceShader>) {
                if (member == &T::ambient_texture) return;
            }
            const ObjectId texture = (material.*member).texture;
            used.textures.insert(texture);
            if (!std::is_same_v<T, scene::Medium> && member != &T::emission_texture)
                used.filtered.insert(texture);
        }
    });
}

// Textures of placed geometries, and of the background.
Used used_textures(const scene::Scene& scene, const FlatScene& flat_scene, const MeshCatalog& meshes) {
    std::set<ObjectId> materials;
    for (const Instance& instance : flat_scene.instances) {
        const scene::Geometry& geometry = meshes.find(instance.geometry)->source;
        materials.insert({geometry.material, geometry.medium});
    }
    Used used;
    for (const ObjectId id : materials) {
        if (const auto* material = scene.find_as<scene::Material>(id)) note_textures(*material, used);
        if (const auto* shader = scene.find_as<scene::SurfaceShader>(id)) note_textures(*shader, used);
        if (const auto* medium = scene.find_as<scene::Medium>(id)) note_textures(*medium, used);
    }
    const auto* root = scene.find_as<scene::Root>(scene::RootId);
    const auto* background = root ? scene.find_as<scene::Background>(root->background) : nullptr;
    if (background != nullptr) used.textures.insert(background->environment);
    return used;
}

}  // namespace

Indices add_textures(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene,
                     const MeshCatalog& meshes, const scene::BlobStore& blobs, MipmapCache& mipmaps) {
    Indices indices;
    const Used used = used_textures(scene, flat_scene, meshes);
    for (const ObjectId id : used.textures) {
        const auto* texture = scene.find_as<scene::Texture>(id);
        if (texture == nullptr) continue;
        scene::BlobPtr texels = blobs.find(texture->texels.hash);
        if (!is_whole(*texture, texels)) continue;
        indices[id] = static_cast<std::uint32_t>(tables.textures.size());
        scene::BlobPtr levels = used.filtered.contains(id) ? mipmaps.levels(*texture, *texels) : nullptr;
        tables.textures.push_back({.texels = {texels->as<std::uint32_t>().data()},
                                   .levels = {elements<std::uint32_t>(levels).data()},
                                   .width = texture->width,
                                   .height = texture->height,
                                   .format = static_cast<std::uint32_t>(texture->format),
                                   .wrap_s = static_cast<std::uint32_t>(texture->wrap_s),
                                   .wrap_t = static_cast<std::uint32_t>(texture->wrap_t),
                                   .texture_filter = static_cast<std::uint32_t>(texture->filter),
                                   .level_count = levels ? level_count(texture->width, texture->height) : 0,
                                   .depth = texture->depth});
        tables.texels.push_back(std::move(texels));
        tables.levels.push_back(std::move(levels));
    }
    mipmaps.drop_unused();
    return indices;
}

}  // namespace tessera::backend
