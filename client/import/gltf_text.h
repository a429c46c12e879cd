#pragma once

#include <span>
#include <string>
#include <string_view>

#include "mediator/base/error.h"

namespace tessera::import {

// Where gltf_text moves the index accessor of a primitive to, among its attributes.
inline constexpr const char* IndicesAttribute = "_TESSERA_INDICES";

// Makes the JSON of a glTF digestible for tinygltf, which refuses the whole file for one bad index accessor
// (and for each one of Draco, which has no buffer view), and which recurses over nested values: moves
// `indices` of primitives into their attributes and refuses deep nesting. Text that is no JSON passes; the
// parser tells of it.
Expected<std::string> prepare_gltf_text(std::string_view json);

// The same for a GLB: checks its frame (magic, version, lengths) and returns a GLB with the JSON chunk
// prepared.
Expected<std::string> prepare_glb(std::span<const unsigned char> bytes);

bool is_glb(std::span<const unsigned char> bytes);

}  // namespace tessera::import
