#include "client/import/gltf_document.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <limits>

#include "client/import/gltf_text.h"
#include "client/import/local_files.h"

namespace tessera::import {
namespace {

constexpr std::array<std::string_view, 15> KnownExtensions{
    "EXT_mesh_gpu_instancing",    "KHR_draco_mesh_compression", "KHR_lights_punctual",
    "KHR_materials_anisotropy",   "KHR_materials_clearcoat",    "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_sheen",        "KHR_materials_specular",
    "KHR_materials_transmission", "KHR_materials_unlit",        "KHR_materials_volume",
    "KHR_mesh_quantization",      "KHR_texture_transform",      "KHR_materials_iridescence"};

bool is_known(std::string_view extension) {
    return std::find(KnownExtensions.begin(), KnownExtensions.end(), extension) != KnownExtensions.end();
}

// User data of tinygltf's file callbacks.
struct FileAccess {
    LocalFolder folder;
    std::vector<std::string> refusals;
};

// tinygltf looks for a name in the base folder (empty here) and then in ".", which is the same folder here.
std::string_view without_dot(std::string_view name) {
    return name.substr(name.starts_with("./") ? 2 : 0);
}

bool file_exists(const std::string& name, void* user) {
    auto& access = *static_cast<FileAccess*>(user);
    const auto found = access.folder.locate(without_dot(name));
    if (found) return true;
    if (std::find(access.refusals.begin(), access.refusals.end(), found.error().what()) ==
        access.refusals.end()) {
        access.refusals.push_back(found.error().what());
    }
    return false;
}

std::string expand_path(const std::string& name, void*) {
    return name;
}

bool read_file(std::vector<unsigned char>* out, std::string* error, const std::string& name, void* user) {
    auto bytes = static_cast<FileAccess*>(user)->folder.read(without_dot(name));
    if (!bytes) {
        if (error) *error += bytes.error().what();
        return false;
    }
    *out = std::move(*bytes);
    return true;
}

bool never_write(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
}

// Keeps the encoded bytes for our own decoder. Bytes in a buffer view are not accessed: tinygltf has not
// checked that the view is within its buffer.
bool keep_encoded(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int byte_size, void*) {
    image->as_is = true;
    if (image->bufferView == -1 && byte_size > 0) image->image.assign(bytes, bytes + byte_size);
    return true;
}

std::string shortened(std::string text) {
    constexpr std::size_t Longest = 300;
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && text.back() == ' ') text.pop_back();
    if (text.size() > Longest) text = text.substr(0, Longest) + "...";
    return text;
}

Expected<void> check_extensions(const tinygltf::Model& model, std::vector<std::string>& notices) {
    std::string unknown;
    for (const std::string& extension : model.extensionsRequired) {
        if (!is_known(extension)) unknown += (unknown.empty() ? "" : ", ") + shortened(extension);
    }
    if (!unknown.empty()) {
        return failure(ErrorCode::InvalidInput,
                       "it requires unknown extensions (" + unknown + "): export it without them");
    }
    for (const std::string& extension : model.extensionsUsed) {
        if (!is_known(extension)) notices.push_back("extension " + shortened(extension) + " is ignored");
    }
    return {};
}

constexpr std::size_t MostNames = 256;

std::vector<std::string> extension_names(const tinygltf::Model& model) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::min(model.extensionsUsed.size(), MostNames); ++i)
        names.push_back(shortened(model.extensionsUsed[i]));
    return names;
}

std::vector<std::string> variant_names(const tinygltf::Model& model) {
    std::vector<std::string> names;
    const auto extension = model.extensions.find("KHR_materials_variants");
    if (extension == model.extensions.end() || !extension->second.Has("variants")) return names;
    const tinygltf::Value& variants = extension->second.Get("variants");
    for (std::size_t i = 0; i < std::min(variants.ArrayLen(), MostNames); ++i) {
        const tinygltf::Value& variant = variants.Get(i);
        const bool has_name = variant.Has("name") && variant.Get("name").IsString();
        names.push_back(has_name ? shortened(variant.Get("name").Get<std::string>()) : "");
    }
    return names;
}

}  // namespace

Expected<GltfDocument> load_gltf(const std::filesystem::path& file) {
    auto bytes = read_whole_file(file);
    if (!bytes) return tl::unexpected<Error>(bytes.error());
    const bool binary = is_glb(*bytes);
    const auto* text = reinterpret_cast<const char*>(bytes->data());
    auto prepared = binary ? prepare_glb(*bytes) : prepare_gltf_text({text, bytes->size()});
    if (!prepared) return tl::unexpected<Error>(prepared.error());
    *bytes = {};

    auto model = std::make_shared<tinygltf::Model>();
    GltfDocument document;
    document.notices = std::move(prepared->notices);
    FileAccess access{LocalFolder(file), {}};
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks({file_exists, expand_path, read_file, never_write, &access});
    loader.SetImageLoader(keep_encoded, nullptr);
    std::string error, warning;
    bool loaded = false;
    const auto length = static_cast<unsigned int>(
        std::min<std::size_t>(prepared->text.size(), std::numeric_limits<unsigned int>::max()));
    try {
        loaded = binary ? loader.LoadBinaryFromMemory(
                              model.get(), &error, &warning,
                              reinterpret_cast<const unsigned char*>(prepared->text.data()), length)
                        : loader.LoadASCIIFromString(model.get(), &error, &warning, prepared->text.data(),
                                                     length, "");
    } catch (const std::exception& problem) {
        error += problem.what();
    }
    for (const std::string& refusal : access.refusals) document.notices.push_back(shortened(refusal));
    if (!loaded) {
        const std::string cause = access.refusals.empty() ? error : access.refusals.front();
        return failure(ErrorCode::InvalidInput, "it is not a complete glTF 2.0 file (" + shortened(cause) +
                                                    "): copy or export it again");
    }
    if (!model->asset.version.starts_with("2.")) {
        return failure(ErrorCode::InvalidInput, "its glTF version is '" + shortened(model->asset.version) +
                                                    "': convert it to glTF 2.0");
    }
    if (const auto checked = check_extensions(*model, document.notices); !checked) {
        return tl::unexpected<Error>(checked.error());
    }
    document.extensions = extension_names(*model);
    document.variants = variant_names(*model);
    document.model = std::move(model);
    return document;
}

double number_member(const tinygltf::Value& object, const char* name, double otherwise) {
    if (!object.Has(name)) return otherwise;
    const tinygltf::Value& value = object.Get(name);
    return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

int index_member(const tinygltf::Value& object, const char* name) {
    if (!object.Has(name)) return -1;
    const tinygltf::Value& value = object.Get(name);
    return value.IsInt() ? value.GetNumberAsInt() : -1;
}

std::vector<double> number_array(const tinygltf::Value& object, const char* name) {
    std::vector<double> numbers;
    if (!object.Has(name)) return numbers;
    const tinygltf::Value& array = object.Get(name);
    for (std::size_t i = 0; i < array.ArrayLen(); ++i) {
        const tinygltf::Value& value = array.Get(static_cast<int>(i));
        if (!value.IsNumber()) return {};
        numbers.push_back(value.GetNumberAsDouble());
    }
    return numbers;
}

}  // namespace tessera::import
