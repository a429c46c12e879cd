#include "client/import/x3d_appearance.h"

#include <cstring>

#include "client/import/x3d_fields.h"
#include "client/import/x3d_placement.h"

namespace tessera::import {
namespace {

// The nodes of an Appearance that are read; the others are counted.
struct Parts {
    pugi::xml_node material, texture, texture_transform;
};

Parts parts_of(X3dDocument& document, pugi::xml_node appearance) {
    Parts parts;
    for (const X3dDocument::Child& child : document.children(appearance)) {
        const std::string_view kind = child.node.name();
        pugi::xml_node* part = kind == "Material"           ? &parts.material
                               : kind == "ImageTexture"     ? &parts.texture
                               : kind == "TextureTransform" ? &parts.texture_transform
                                                            : nullptr;
        if (part == nullptr || *part) {
            document.problems().skipped(child.node.name(), child.node.offset_debug());
        } else {
            *part = child.node;
        }
    }
    return parts;
}

}  // namespace

X3dSurface X3dAppearances::surface(pugi::xml_node appearance, X3dSides sides) {
    const auto [place, is_new] = made_.try_emplace({appearance.internal_object(), sides});
    if (is_new) place->second = make(appearance, sides);
    return place->second;
}

X3dSurface X3dAppearances::make(pugi::xml_node appearance, X3dSides sides) {
    const Parts parts = parts_of(document_, appearance);
    X3dSurface surface;
    if (parts.texture_transform) {
        surface.texture_transform =
            texture_transform(X3dFields(parts.texture_transform, document_.problems()));
    }
    scene::Material material;
    material.name = x3d_name(parts.material ? parts.material : appearance);
    material.double_sided = !sides.solid;
    glm::vec3 color(1.0f);
    float alpha = 1.0f;
    const X3dTextures::Traits traits =
        parts.texture ? textures_.traits(parts.texture) : X3dTextures::Traits{};
    if (parts.material) {
        const X3dFields fields(parts.material, document_.problems());
        color = fields.vector("diffuseColor", glm::vec3(0.8f), UpToOne);
        alpha = 1.0f - static_cast<float>(fields.number("transparency", 0.0, UpToOne));
        material.emission = fields.vector("emissiveColor", glm::vec3(0.0f), UpToOne);
        const bool replaced = parts.texture && !traits.is_grey && document_.version() < 4.0;
        if (sides.has_colors || replaced) color = glm::vec3(1.0f);
    } else {
        material.unlit = true;
    }
    material.base_color = glm::vec4(color, alpha);
    if (parts.texture) {
        material.base_color_texture.texture = textures_.texture(parts.texture, TextureUse::Color);
        surface.is_textured = true;
    }
    if (alpha < 1.0f || traits.has_opacity) material.alpha_mode = scene::AlphaMode::Blend;
    surface.material = builder_.add(std::move(material));
    return surface;
}

}  // namespace tessera::import
