#include "client/import/x3d_appearance.h"

#include <string_view>

#include "client/import/x3d_fields.h"
#include "client/import/x3d_placement.h"
#include "client/import/x3d_shaders.h"
#include "mediator/scene/fields.h"

namespace tessera::import {

X3dAppearances::Parts X3dAppearances::parts_of(pugi::xml_node appearance) {
    Parts parts;
    for (const X3dDocument::Child& child : document_.children(appearance)) {
        const std::string_view kind = child.node.name();
        pugi::xml_node* part = kind == "CommonSurfaceShader"  ? &parts.shader
                               : kind == "CommonVolumeShader" ? &parts.volume
                               : kind == "Material"           ? &parts.material
                               : kind == "ImageTexture"       ? &parts.texture
                               : kind == "TextureTransform"   ? &parts.texture_transform
                                                              : nullptr;
        if (part == nullptr || *part) {
            document_.diagnostics().skipped(child.node.name(), child.node.offset_debug());
        } else {
            *part = child.node;
        }
    }
    return parts;
}

X3dSurface X3dAppearances::surface(pugi::xml_node appearance, VertexColors colors) {
    const auto [entry, is_new] = surfaces_.try_emplace({appearance.internal_object(), colors});
    if (is_new) entry->second = make(appearance, colors);
    return entry->second;
}

X3dSurface X3dAppearances::make(pugi::xml_node appearance, VertexColors colors) {
    const Parts parts = parts_of(appearance);
    X3dSurface surface;
    if (parts.shader) {
        add_shader(parts.shader, surface);
    } else if (parts.material) {
        add_material(parts, colors, surface);
    } else if (!parts.volume || parts.texture) {  // a volume alone has no surface material
        add_unlit(appearance, parts.texture, surface);
    }
    if (parts.volume) surface.medium = medium(parts.volume);
    if (parts.texture_transform) {
        surface.texture_transform =
            texture_transform(X3dFields(parts.texture_transform, document_.diagnostics()));
    }
    return surface;
}

void X3dAppearances::add_shader(pugi::xml_node node, X3dSurface& surface) {
    const auto [entry, is_new] = shaders_.try_emplace(node.internal_object());
    if (is_new) {
        scene::SurfaceShader shader = read_surface_shader(document_, node, textures_);
        X3dSurface& result = entry->second;
        // Tangents are generated from texture coordinates, also when only an anisotropic highlight needs
        // them.
        result.needs_tangents = shader.normal_texture.texture || shader.height_texture.texture ||
                                shader.shininess.x != shader.shininess.y;
        result.is_textured = result.needs_tangents;
        scene::for_each_field<scene::SurfaceShader>([&](unsigned, auto member) {
            if constexpr (std::is_same_v<decltype(member), scene::TextureSlot scene::SurfaceShader::*>)
                result.is_textured |= static_cast<bool>((shader.*member).texture);
        });
        result.material = builder_.add(std::move(shader));
    }
    surface = entry->second;
}

void X3dAppearances::add_material(const Parts& parts, VertexColors colors, X3dSurface& surface) {
    scene::SurfaceShader shader = read_material(document_, parts.material);
    if (colors == VertexColors::Given) shader.diffuse = glm::vec3(1.0f);
    if (parts.texture) {
        const X3dTextures::Traits traits = textures_.traits(parts.texture);
        // X3D 3 (17.2.2.5): a coloured image replaces the diffuse colour; X3D 4 multiplies.
        if (!traits.is_grey && document_.version() < 4.0) shader.diffuse = glm::vec3(1.0f);
        shader.diffuse_texture.texture =
            textures_.texture(parts.texture, TextureUse::Color, x3d_label(parts.material));
        if (traits.has_opacity) shader.alpha_texture = shader.diffuse_texture;
        surface.is_textured = true;
    }
    surface.material = builder_.add(std::move(shader));
}

void X3dAppearances::add_unlit(pugi::xml_node appearance, pugi::xml_node texture, X3dSurface& surface) {
    scene::Material material;
    material.name = x3d_name(appearance);
    material.base_color = glm::vec4(1.0f);
    material.unlit = true;
    material.double_sided = true;
    if (texture) {
        material.base_color_texture.texture =
            textures_.texture(texture, TextureUse::Color, x3d_label(appearance));
        if (textures_.traits(texture).has_opacity) material.alpha_mode = scene::AlphaMode::Blend;
        surface.is_textured = true;
    }
    surface.material = builder_.add(std::move(material));
}

ObjectId X3dAppearances::medium(pugi::xml_node node) {
    ObjectId& result = media_[node.internal_object()];
    if (!result) result = builder_.add(read_medium(document_, node, textures_));
    return result;
}

}  // namespace tessera::import
