#pragma once

#include <span>
#include <variant>

#include "client/import/texture_use.h"
#include "mediator/scene/materials.h"

// Members of the KHR_materials_* extensions that map one to one to fields of a Material. The importer, its
// value check and the exporter use this table; other members (KHR_materials_unlit, the scale of a normal
// texture, the strength of emission) are handled in code.
namespace tessera::import {

struct GltfMember {
    const char *extension, *name;
    std::variant<float scene::Material::*, glm::vec3 scene::Material::*,
                 scene::TextureSlot scene::Material::*>
        field;
    double least = 0.0, most = 1.0;  // range of numbers, by the specification of the extension
};

// Members of one extension are contiguous.
std::span<const GltfMember> gltf_members();

// The use of the texture in this field.
TextureUse use_of(scene::TextureSlot scene::Material::*field);

}  // namespace tessera::import
