#include "client/import/import.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <exception>
#include <new>

#include "client/import/assimp_import.h"
#include "client/import/gltf_import.h"
#include "client/import/motion_keys.h"
#include "client/import/ply_import.h"
#include "client/import/post_process.h"
#include "client/import/tessera_import.h"
#include "client/import/x3d_import.h"
#include "mediator/scene/fields.h"

namespace tessera::import {
namespace {

std::string lower_case_extension(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

void check_options(const ImportOptions& options) {
    if (options.first_id <= scene::RootId || options.first_id >= options.end_id ||
        options.end_id.value > 1ull << 32) {
        throw Error(ErrorCode::InvalidInput,
                    "the range of object ids is empty, above 2^32 or contains the root's id");
    }
    if (options.at && !(std::abs(*options.at) <= 1e9))
        throw Error(ErrorCode::InvalidInput, "the time must be a number of seconds up to 1e9");
    if (!(options.shutter >= 0.0 && options.shutter <= 1e9))
        throw Error(ErrorCode::InvalidInput, "the shutter must be open for 0 to 1e9 seconds");
    if (options.shutter > 0.0 && !options.at)
        throw Error(ErrorCode::InvalidInput, "a shutter needs the time at which it opens");
    const glm::vec3 color = options.background.value_or(glm::vec3(0.0f));
    for (const float value : {color.x, color.y, color.z, options.environment_strength}) {
        if (!(value >= 0.0f && value <= 1e12f)) {
            throw Error(ErrorCode::InvalidInput,
                        "background and environment strength must be finite and not negative");
        }
    }
    if (!std::isfinite(options.environment_rotation))
        throw Error(ErrorCode::InvalidInput, "the rotation of the environment must be finite");
}

void check_animations(SceneBuilder& builder) {
    const ImportOptions& options = builder.options();
    if (!builder.result().animations.empty()) return;
    if (!options.animation.empty())
        throw Error(ErrorCode::InvalidInput, "it has no animation '" + options.animation + "' and no other");
    if (options.at) builder.notice("the file has no animation: the time is ignored");
}

void read_into(const std::filesystem::path& file, SceneBuilder& builder) {
    const std::string extension = lower_case_extension(file);
    if (extension == ".tessera") {
        const ImportOptions& options = builder.options();
        if (options.soft_lights_as_sky || !options.lights_as_sky.empty())
            throw Error(
                ErrorCode::InvalidInput,
                "lights can be left out only of imported files, not of saved scenes: hide them instead");
        import_tessera(file, builder);
        return check_animations(builder);
    }
    if (extension == ".gltf" || extension == ".glb") {
        import_gltf(file, builder);
    } else if (extension == ".ply") {
        import_ply(file, builder);
    } else if (extension == ".x3d") {
        return post_process(builder, import_x3d(file, builder));
    } else if (is_assimp_extension(extension)) {
        import_with_assimp(file, builder);
    } else if (extension == ".x3dz" || extension == ".x3db" || extension == ".x3dv" || extension == ".wrl") {
        throw Error(ErrorCode::InvalidInput, "only the XML encoding of X3D is supported: convert it to .x3d");
    } else {
        throw Error(
            ErrorCode::InvalidInput,
            "its extension is none of .gltf, .glb, .obj, .ply, .stl, .x3d and .tessera: convert it to "
            "glTF 2.0");
    }
    check_animations(builder);
    post_process(builder);
}

bool moves(const ImportedScene& scene) {
    return std::any_of(scene.objects.begin(), scene.objects.end(), [](const scene::Create& create) {
        const auto* transform = std::get_if<scene::Transform>(&create.object);
        return transform && !transform->motion.empty();
    });
}

}  // namespace

Expected<ImportedScene> import_scene(const std::filesystem::path& file, const ImportOptions& options) {
    const std::string named = "scene '" + file.string() + "': ";
    try {
        check_options(options);
        if (std::error_code error; !std::filesystem::exists(file, error)) {
            return failure(ErrorCode::NotFound, named + "there is no such file: check the name");
        }
        SceneBuilder builder(options);
        read_into(file, builder);
        ImportedScene& scene = builder.result();
        if (options.shutter > 0.0 && scene.playback) {
            scene.shutter = options.shutter;
            if (auto opened = move_to(scene, *options.at); !opened) throw opened.error();
            if (options.motion == Motion::Still) scene.playback.reset();
        } else if (moves(scene)) {
            move_cameras(scene);
        }
        return std::move(builder.result());
    } catch (const Error& error) {
        return failure(error.code(), named + error.what());
    } catch (const std::bad_alloc&) {
        return failure(ErrorCode::OutOfMemory, named + "not enough memory to load it: split the scene");
    } catch (const std::exception& error) {  // of third-party parsers
        return failure(ErrorCode::InvalidInput,
                       named + "it cannot be read (" + error.what() + "): export it again");
    }
}

std::vector<scene::Entry> entries(const ImportedScene& scene, RootEntry root) {
    std::vector<scene::Entry> result;
    result.reserve(scene.objects.size() + 1);
    if (root == RootEntry::Create) {
        result.emplace_back(scene::Create{scene::RootId, scene.root});
    } else {
        const scene::Fields<scene::Root> fields{&scene::Root::children, &scene::Root::background};
        result.push_back(scene::Update{scene::RootId, fields.bits(), scene.root});
    }
    result.insert(result.end(), scene.objects.begin(), scene.objects.end());
    return result;
}

}  // namespace tessera::import
