#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::import {

// Where gltf_text moves the index accessor of a primitive to, among its attributes.
inline constexpr const char* IndicesAttribute = "_TESSERA_INDICES";

struct PreparedText {
    std::string text;
    std::vector<std::string> notices;  // of values that were taken out
};

// Makes the JSON of a glTF digestible for tinygltf, which refuses the whole file for one bad index accessor
// (and for each one of Draco, which has no buffer view), and which recurses over nested values: moves
// `indices` of primitives into their attributes and refuses deep nesting. Takes out of materials what
// check_gltf_materials finds wrong, also numbers that JSON cannot say, as NaN. Text that is no JSON passes;
// the parser tells of it.
Expected<PreparedText> prepare_gltf_text(std::string_view json);

// The same for a GLB: checks its frame (magic, version, lengths) and returns a GLB with the JSON chunk
// prepared.
Expected<PreparedText> prepare_glb(std::span<const unsigned char> bytes);

bool is_glb(std::span<const unsigned char> bytes);

}  // namespace tessera::import
