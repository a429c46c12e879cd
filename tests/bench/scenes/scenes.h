#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "client/import/import.h"
#include "mediator/scene/scene.h"

namespace tessera::tools::bench {

// What filters are measured on. `kind` says what makes it noisy, in the words of the report.
struct BenchScene {
    std::string name, kind, summary;
    scene::Scene content;  // version {1, 1}
    std::vector<scene::BlobPtr> blobs;
    import::CameraInfo camera;
    std::uint32_t max_bounces = 8;
};

// All scenes by name, the default list: files of the folder `assets` that are there, then the built-in ones.
std::vector<std::string> scene_names(const std::filesystem::path& assets);

// The scenes of a list "a,b", all for "": whether each is there is known before the work. NotFound.
Expected<std::vector<std::string>> choose_scenes(const std::string& list,
                                                 const std::filesystem::path& assets);

// One of those, "balls:N" (built_in_scenes.h), or a scene file. NotFound, InvalidInput.
Expected<BenchScene> load_scene(const std::string& name, const std::filesystem::path& assets);

}  // namespace tessera::tools::bench
