#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/base/error.h"

namespace tinygltf {
class Model;
class Value;
}  // namespace tinygltf

namespace tessera::import {

// A glTF file as tinygltf reads it: buffers and external images are loaded, images are not decoded. tinygltf
// validates almost nothing, so the numbers in the model are untrusted.
struct GltfDocument {
    std::shared_ptr<const tinygltf::Model> model;
    std::vector<std::string> extensions, variants;  // names, as ImportedScene has them
    std::vector<std::string>
        notices;  // files that could not be read and values that were removed, with the cause
};

// Errors as of import_scene, without the file name in the message.
Expected<GltfDocument> load_gltf(const std::filesystem::path& file);

// Members of a JSON object, or the default if they are absent or of another type.
double number_member(const tinygltf::Value& object, const char* name, double otherwise);
int index_member(const tinygltf::Value& object, const char* name);  // -1 when absent
std::vector<double> number_array(const tinygltf::Value& object, const char* name);

}  // namespace tessera::import
