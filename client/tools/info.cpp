#include "client/tools/info.h"

#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/import/import.h"
#include "client/tools/formatted.h"
#include "mediator/base/description.h"
#include "mediator/scene/objects.h"

namespace tessera::tools {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* InfoName = "info";

struct InfoOptions {
    std::string scene;
    bool json = false;
};

struct Totals {
    std::uint64_t file_bytes = 0, blob_bytes = 0;
    std::map<std::string, std::uint64_t> objects, lights;  // by kind
};

Totals totals(const InfoOptions& options, const import::ImportedScene& scene) {
    Totals all;
    std::error_code ignored;
    const auto size = std::filesystem::file_size(options.scene, ignored);
    if (!ignored) all.file_bytes = size;
    for (const scene::BlobPtr& blob : scene.blobs) all.blob_bytes += blob->bytes().size();
    for (const scene::Create& entry : scene.objects) {
        ++all.objects[scene::name(scene::kind(entry.object))];
        if (const auto* light = std::get_if<scene::Light>(&entry.object))
            ++all.lights[std::string(enumerator_name(light->kind))];
    }
    return all;
}

std::string mebibytes(std::uint64_t bytes) {
    return formatted("%.1f MiB", static_cast<double>(bytes) / 1048576.0);
}

std::string list(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& one : names) text += (text.empty() ? "" : ", ") + one;
    return names.empty() ? "none" : std::to_string(names.size()) + ": " + text;
}

std::string list(const std::map<std::string, std::uint64_t>& counts) {
    std::string text;
    for (const auto& [what, count] : counts)
        text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
    return text.empty() ? "none" : text;
}

std::vector<std::string> camera_names(const import::ImportedScene& scene) {
    std::vector<std::string> names;
    for (const import::CameraInfo& camera : scene.cameras) names.push_back(camera.name);
    return names;
}

void print(const InfoOptions& options, const import::ImportedScene& scene, const Totals& all) {
    std::vector<std::string> animations;
    for (const import::AnimationInfo& animation : scene.animations)
        animations.push_back(animation.name + formatted(" (%.4g s)", animation.seconds));
    const import::ImportCounts& counts = scene.counts;
    const auto line = [](const char* what, const std::string& text) {
        std::cout << formatted("%-12s", what) << text << "\n";
    };
    line("file", options.scene + ", " + mebibytes(all.file_bytes));
    line("triangles", std::to_string(counts.triangles) + " in " + std::to_string(counts.geometries) +
                          " geometries, placed " + std::to_string(counts.instances) + " times" +
                          (counts.degenerate_triangles > 0
                               ? "; " + std::to_string(counts.degenerate_triangles) + " without area"
                               : ""));
    line("arrays", mebibytes(all.blob_bytes) + " of vertices and textures");
    line("objects", list(all.objects));
    line("lights",
         list(all.lights) + (counts.emissive_geometries > 0
                                 ? ", " + std::to_string(counts.emissive_geometries) + " emissive geometries"
                                 : ""));
    line("cameras", list(camera_names(scene)));
    line("animations", list(animations));
    line("variants", list(scene.variants));
    line("extensions", list(scene.extensions));
    for (const std::string& notice : scene.notices) line("note", notice);
}

Json as_json(const InfoOptions& options, const import::ImportedScene& scene, const Totals& all) {
    Json animations = Json::array();
    for (const import::AnimationInfo& animation : scene.animations)
        animations.push_back({{"name", animation.name}, {"seconds", animation.seconds}});
    return {{"file", options.scene},
            {"bytes", all.file_bytes},
            {"array_bytes", all.blob_bytes},
            {"triangles", scene.counts.triangles},
            {"degenerate_triangles", scene.counts.degenerate_triangles},
            {"geometries", scene.counts.geometries},
            {"instances", scene.counts.instances},
            {"emissive_geometries", scene.counts.emissive_geometries},
            {"objects", all.objects},
            {"lights", all.lights},
            {"cameras", camera_names(scene)},
            {"animations", animations},
            {"variants", scene.variants},
            {"extensions", scene.extensions},
            {"notes", scene.notices}};
}

int run(const InfoOptions& options) {
    const auto scene = import::import_scene(options.scene, {.missing = import::Missing::Leave});
    if (!scene) return report_error(InfoName, ExitBadInput, scene.error().what());
    const Totals all = totals(options, *scene);
    if (options.json) {
        std::cout << as_json(options, *scene, all).dump(2, ' ', false, Json::error_handler_t::replace)
                  << "\n";
    } else {
        print(options, *scene, all);
    }
    return 0;
}

}  // namespace

Command info_command(cli::CommandLine& program) {
    const auto options = std::make_shared<InfoOptions>();
    cli::CommandLine& line = program.command(
        InfoName,
        "Print the contents of a scene file: triangles, lights, cameras, animations, variants, extensions.");
    line.positional("SCENE", "scene file, as for tessera render", options->scene);
    line.flag("--json", "print one JSON object", options->json);
    line.examples({"tessera info room.glb", "tessera info robot.gltf --json"});
    return {InfoName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools
