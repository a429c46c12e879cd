#pragma once

#include <functional>
#include <string>

#include "client/import/scene_builder.h"
#include "client/import/texture_use.h"

namespace tinygltf {
class Value;
}

// What glTF has no place for stands in its `extras`: objects whose members are fields of ours
// (mediator/scene/objects.h). Numbers and flags are themselves, vectors arrays, enumerators words, textures
// glTF's textureInfo. Other programs see what glTF says instead.
namespace tessera::import {

inline constexpr const char* LightExtras = "tessera_light";            // of a light
inline constexpr const char* CameraExtras = "tessera_camera";          // of a camera
inline constexpr const char* MaterialExtras = "tessera_material";      // of a material
inline constexpr const char* ShaderExtras = "tessera_surface_shader";  // of a material, which is one then
inline constexpr const char* MediaExtras = "tessera_media";            // of the file: an array of them
inline constexpr const char* MediumExtras = "tessera_medium";          // of a primitive: which of them
inline constexpr const char* DepthExtras = "tessera_depth";  // of a texture: slices, from the top down

// A member of extras that is an object; else null.
const tinygltf::Value* object_extras(const tinygltf::Value& extras, const char* name);

// A texture that a member of an object names.
using ReadSlot =
    std::function<scene::TextureSlot(const tinygltf::Value& owner, const char* member, TextureUse use)>;

// Sets the fields of the object that `from` has members for: of a Light, Camera, Material, SurfaceShader or
// Medium. What is of another type or out of range stays as it was and is told, and so are members that are no
// fields; `owner` says whose they are.
template <class T>
void read_extras(const tinygltf::Value& from, T& object, const std::string& owner, SceneBuilder& builder,
                 const ReadSlot& read_slot = {});

}  // namespace tessera::import
