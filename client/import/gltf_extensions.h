#pragma once

#include <span>
#include <variant>

#include "client/import/texture_use.h"
#include "mediator/scene/materials.h"

// Which members of the KHR_materials_* extensions are fields of a Material, as they are. The importer, its check
// of values and the exporter go along this table; what is no plain copy (KHR_materials_unlit, the scale of a
// texture of normals, the strength of emission) stands in their code.
namespace tessera::import {

struct GltfMember {
    const char *extension, *name;
    std::variant<float scene::Material::*, glm::vec3 scene::Material::*,
                 scene::TextureSlot scene::Material::*>
        field;
    double least = 0.0, most = 1.0;  // of numbers, as the extension's specification has it
};

// Members of one extension stand together.
std::span<const GltfMember> gltf_members();

// By the row of the field.
TextureUse use_of(scene::TextureSlot scene::Material::*field);

}  // namespace tessera::import
