#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tessera::import {

struct CheckedMaterials {
    std::string json;                  // without what is wrong; "" = as it was
    std::vector<std::string> notices;  // one for each wrong value: material, field, value, remedy
};

// Checks the fields of glTF's materials and of their extensions that are read: a value of another type, or
// outside of the range that the specification gives, is taken out, so that its default stands. The
// specification clamps none of them. An emissive factor above 1 stays, as many files mean it. Text that is no
// array of JSON passes; who parses it tells of that.
CheckedMaterials check_gltf_materials(std::string_view json);

}  // namespace tessera::import
