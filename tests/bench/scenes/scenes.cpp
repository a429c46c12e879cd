#include "tests/bench/scenes/scenes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "client/tools/values.h"
#include "mediator/base/nearest.h"
#include "tests/bench/scenes/built_in_scenes.h"

namespace tessera::tools::bench {

namespace {

namespace fs = std::filesystem;

struct SceneFile {
    const char *name, *kind, *summary, *file, *environment;
};
constexpr std::array Files{
    SceneFile{"room-1", "indirect light", "closed textured room lit over its ceiling", "room-1.glb", ""},
    SceneFile{"studio-1", "glossy surfaces", "metals and coated paint between soft boxes", "studio-1.glb",
              ""},
    SceneFile{"interior-1", "interior",
              "room lit through panes, with masked leaves, normal maps and a mirrored vase", "interior-1.glb",
              "env-noon.exr"},
    SceneFile{"still", "environment light", "still life with glass and copper in a studio's light",
              "still.glb", "env-studio.exr"},
};

constexpr std::string_view Balls = "balls:";
constexpr std::uint32_t MostBallTriangles = 50'000'000;

// Of "balls:N".
Expected<std::uint32_t> ball_triangles(const std::string& name) {
    std::uint32_t triangles = 0;
    const char* last = name.data() + name.size();
    const auto read = std::from_chars(name.data() + Balls.size(), last, triangles);
    if (read.ec == std::errc() && read.ptr == last && triangles <= MostBallTriangles) return triangles;
    return failure(ErrorCode::InvalidInput, "'" + name + "' has no valid number of triangles up to " +
                                                std::to_string(MostBallTriangles) + ": write balls:1000000");
}

Expected<BenchScene> import_file(const SceneFile& wanted, const fs::path& path, const fs::path& environment) {
    auto imported = import::import_scene(path, {.environment = environment});
    if (!imported) return tl::unexpected(imported.error());
    BenchScene scene{.name = wanted.name,
                     .kind = wanted.kind,
                     .summary = wanted.summary,
                     .file = path,
                     .environment = environment};
    scene.camera = imported->cameras.front();
    if (auto applied = scene.content.apply_entries(import::entries(*imported, import::RootEntry::Create));
        !applied) {
        return tl::unexpected(applied.error());
    }
    scene.content.set_version({1, 1});
    scene.blobs = std::move(imported->blobs);
    return scene;
}

}  // namespace

std::vector<std::string> scene_names(const fs::path& assets) {
    std::vector<std::string> names;
    for (const SceneFile& file : Files) {
        const bool lit = *file.environment == '\0' || fs::exists(assets / file.environment);
        if (lit && fs::exists(assets / file.file)) names.emplace_back(file.name);
    }
    for (const BuiltIn& scene : built_in_scenes()) {
        if (scene.is_default) names.emplace_back(scene.name);
    }
    return names;
}

Expected<std::vector<std::string>> choose_scenes(const std::string& list, const fs::path& assets) {
    const std::vector<std::string> known = scene_names(assets);
    if (list.empty()) return known;
    std::vector<std::string> chosen = split_list(list);
    for (const std::string& name : chosen) {
        const bool is_known =
            std::ranges::find(known, name) != known.end() ||
            std::ranges::find(built_in_scenes(), name, &BuiltIn::name) != built_in_scenes().end();
        if (is_known || fs::exists(name)) continue;
        if (name.starts_with(Balls) && ball_triangles(name)) continue;
        return tl::unexpected(load_scene(name, assets).error());
    }
    return chosen;
}

Expected<BenchScene> load_scene(const std::string& name, const fs::path& assets) {
    const auto& built_in = built_in_scenes();
    const auto built = std::find_if(built_in.begin(), built_in.end(),
                                    [&](const BuiltIn& scene) { return scene.name == name; });
    if (built != built_in.end()) return built->make();
    if (name.starts_with(Balls)) {
        const auto triangles = ball_triangles(name);
        if (!triangles) return tl::unexpected(triangles.error());
        return balls(*triangles);
    }
    const auto file = std::find_if(Files.begin(), Files.end(),
                                   [&](const SceneFile& candidate) { return candidate.name == name; });
    if (file != Files.end()) {
        const fs::path environment = *file->environment ? assets / file->environment : fs::path();
        return import_file(*file, assets / file->file, environment);
    }
    if (fs::exists(name)) {
        const std::string stem = fs::path(name).stem().string();
        return import_file({stem.c_str(), "user file", name.c_str(), "", ""}, name, {});
    }
    const std::vector<std::string> names = scene_names(assets);
    const auto meant = nearest(name, names);
    std::string list;
    for (const std::string& known : names) list += (list.empty() ? "" : ", ") + known;
    return failure(ErrorCode::NotFound, "unknown scene '" + name + "'" +
                                            (meant ? "; did you mean '" + *meant + "'" : "") +
                                            ": give a file, or one of " + list);
}

}  // namespace tessera::tools::bench
