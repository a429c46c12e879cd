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
    std::vector<std::string> notices;  // about removed values
};

// Prepares the JSON of a glTF for tinygltf, which rejects the whole file for one invalid index accessor (also
// for those of Draco, which have no buffer view) and recurses over nested values: moves `indices` of
// primitives into their attributes and rejects deep nesting. Removes the values of materials that
// check_gltf_materials rejects, and numbers that are not valid JSON, such as NaN. Invalid JSON passes; the
// parser reports it.
Expected<PreparedText> prepare_gltf_text(std::string_view json);

// The same for a GLB: checks its headers (magic, version, lengths) and returns a GLB with a prepared JSON
// chunk.
Expected<PreparedText> prepare_glb(std::span<const unsigned char> bytes);

bool is_glb(std::span<const unsigned char> bytes);

}  // namespace tessera::import
