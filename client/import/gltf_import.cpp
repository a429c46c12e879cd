#include "client/import/gltf_import.h"

#include <tiny_gltf.h>

#include "client/import/gltf_document.h"
#include "client/import/gltf_nodes.h"

namespace tessera::import {

void import_gltf(const std::filesystem::path& file, SceneBuilder& builder) {
    const Expected<GltfDocument> document = load_gltf(file);
    if (!document) throw document.error();
    for (const std::string& notice : document->notices) builder.notice(notice);
    if (!document->model->animations.empty())
        builder.notice("animations are ignored: the pose in the file is drawn");
    builder.result().root.children = GltfNodes(*document->model, builder).build();
}

}  // namespace tessera::import
