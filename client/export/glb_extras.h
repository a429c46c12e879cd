#pragma once

#include <functional>
#include <optional>

#include "mediator/scene/fields.h"

namespace tinygltf {
class Value;
}

namespace tessera::exporting {

// The textureInfo of a slot; none if the texture cannot be written.
using WriteSlot = std::function<std::optional<tinygltf::Value>(const scene::TextureSlot& slot)>;

// The fields of `mask` as client/import/gltf_extras.h reads them: of a Light, Camera, Material, SurfaceShader
// or Medium. Empty texture slots are left out.
template <class T>
tinygltf::Value extras_of(const T& object, scene::Fields<T> mask, const WriteSlot& write_slot = {});

// The fields that differ.
template <class T>
scene::Fields<T> changed_fields(const T& object, const T& otherwise);

}  // namespace tessera::exporting
