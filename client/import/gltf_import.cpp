#include "client/import/gltf_import.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstdio>

#include "client/import/gltf_animation.h"
#include "client/import/gltf_document.h"
#include "client/import/gltf_nodes.h"

namespace tessera::import {
namespace {

void add_animations_notice(SceneBuilder& builder) {
    constexpr std::size_t MostListed = 8;
    const std::vector<AnimationInfo>& animations = builder.result().animations;
    if (animations.empty()) return;
    std::string list;
    for (std::size_t i = 0; i < std::min(animations.size(), MostListed); ++i) {
        char length[32];
        std::snprintf(length, sizeof length, " (%.4g s)", animations[i].seconds);
        list += (i == 0 ? "" : ", ") + std::to_string(i) + " '" + animations[i].name + "'" + length;
    }
    if (animations.size() > MostListed) list += " and more";
    const bool at_rest = !builder.options().at;
    builder.notice("animations: " + list + (at_rest ? "; the rest pose is drawn" : ""));
}

}  // namespace

void import_gltf(const std::filesystem::path& file, SceneBuilder& builder) {
    const Expected<GltfDocument> document = load_gltf(file);
    if (!document) throw document.error();
    for (const std::string& notice : document->notices) builder.notice(notice);
    builder.result().extensions = document->extensions;
    builder.result().variants = document->variants;
    builder.result().animations = list_animations(*document->model, builder);
    add_animations_notice(builder);
    builder.result().root.children = GltfNodes(*document->model, builder).build();
}

}  // namespace tessera::import
