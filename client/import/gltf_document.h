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

// A glTF file as tinygltf reads it, buffers and external images loaded, images not decoded. tinygltf checks
// next to nothing: every number in here is still the file's word.
struct GltfDocument {
    std::shared_ptr<const tinygltf::Model> model;
    std::vector<std::string> extensions, variants;  // names, as ImportedScene has them
    std::vector<std::string> notices;  // files that could not be read, values that were taken out, and why
};

// Fails as import_scene does, without the file's name in the message.
Expected<GltfDocument> load_gltf(const std::filesystem::path& file);

// Members of an extension's object, or the default where they are absent or of another type.
double number_member(const tinygltf::Value& object, const char* name, double otherwise);
int index_member(const tinygltf::Value& object, const char* name);  // -1 when absent
std::vector<double> number_array(const tinygltf::Value& object, const char* name);

}  // namespace tessera::import
