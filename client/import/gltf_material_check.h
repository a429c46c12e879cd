#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tessera::import {

struct CheckedMaterials {
    std::string json;                  // without the invalid values; "" = unchanged
    std::vector<std::string> notices;  // one per invalid value: material, field, value, remedy
};

// Validates the supported fields of glTF materials and their extensions: values of the wrong type or outside
// the range of the specification are removed, so that the default applies (the specification does not ask for
// clamping). An emissive factor above 1 is kept, as many files use it. Text that is not a JSON array passes;
// the parser reports it.
CheckedMaterials check_gltf_materials(std::string_view json);

}  // namespace tessera::import
