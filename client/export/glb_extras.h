#pragma once

#include <functional>
#include <optional>

#include "mediator/scene/fields.h"

namespace tinygltf {
class Value;
}

namespace tessera::exporting {

// A texture's textureInfo; none for one that cannot be written.
using WriteSlot = std::function<std::optional<tinygltf::Value>(const scene::TextureSlot& slot)>;

// The fields of `mask` as client/import/gltf_extras.h reads them: of a Light, Camera, Material, SurfaceShader
// or Medium. Textures that are not there are left out.
template <class T>
tinygltf::Value extras_of(const T& object, scene::Fields<T> mask, const WriteSlot& write_slot = {});

// Those that differ.
template <class T>
scene::Fields<T> fields_beside(const T& object, const T& otherwise);

}  // namespace tessera::exporting
