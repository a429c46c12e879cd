#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "client/import/import.h"
#include "mediator/scene/scene.h"

namespace tessera::tools::bench {

// A benchmark scene. `kind`: its cause of noise, as shown in the report.
struct BenchScene {
    std::string name, kind, summary;
    scene::Scene content;  // version {1, 1}
    std::vector<scene::BlobPtr> blobs;
    import::CameraInfo camera;
    std::uint32_t max_bounces = 8;
    std::filesystem::path file, environment;  // that it was imported from; empty: built-in
};

// The default list of scene names: existing files of the folder `assets`, then the built-in ones.
std::vector<std::string> scene_names(const std::filesystem::path& assets);

// Parses a list "a,b" ("": all) and checks that each scene exists. NotFound.
Expected<std::vector<std::string>> choose_scenes(const std::string& list,
                                                 const std::filesystem::path& assets);

// Loads a scene by name, "balls:N" (built_in_scenes.h), or a scene file. NotFound, InvalidInput.
Expected<BenchScene> load_scene(const std::string& name, const std::filesystem::path& assets);

}  // namespace tessera::tools::bench
