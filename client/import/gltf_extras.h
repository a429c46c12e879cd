#pragma once

#include <functional>
#include <string>

#include "client/import/scene_builder.h"
#include "client/import/texture_use.h"

namespace tinygltf {
class Value;
}

// Properties that glTF cannot express are stored in `extras`: objects whose members are fields of scene
// objects (mediator/scene/objects.h). Vectors are arrays, enumerators are strings, textures are glTF's
// textureInfo. Other programs use the closest standard glTF properties instead.
namespace tessera::import {

inline constexpr const char* LightExtras = "tessera_light";        // of a light
inline constexpr const char* CameraExtras = "tessera_camera";      // of a camera
inline constexpr const char* MaterialExtras = "tessera_material";  // of a material
inline constexpr const char* ShaderExtras =
    "tessera_surface_shader";                                // of a material, which then is a surface shader
inline constexpr const char* MediaExtras = "tessera_media";  // of the file: an array of media
inline constexpr const char* MediumExtras = "tessera_medium";  // of a primitive: index into that array
inline constexpr const char* DepthExtras = "tessera_depth";    // of a texture: slices, from the top down

// The member if it is an object; else null.
const tinygltf::Value* object_extras(const tinygltf::Value& extras, const char* name);

// Reads the texture that a member of an object refers to.
using ReadSlot =
    std::function<scene::TextureSlot(const tinygltf::Value& owner, const char* member, TextureUse use)>;

// Sets the fields of a Light, Camera, Material, SurfaceShader or Medium from the members of `from`. Values of
// the wrong type or out of range are ignored with a notice, as are unknown members; `owner` names the object
// in the notice.
template <class T>
void read_extras(const tinygltf::Value& from, T& object, const std::string& owner, SceneBuilder& builder,
                 const ReadSlot& read_slot = {});

}  // namespace tessera::import
