#include "client/import/x3d_import.h"

#include "client/import/x3d_background.h"
#include "client/import/x3d_nodes.h"

namespace tessera::import {

scene::Background import_x3d(const std::filesystem::path& file, SceneBuilder& builder) {
    X3dDocument document(file);
    X3dTextures textures(document, LocalFolder(file), builder);
    X3dAppearances appearances(document, textures, builder);
    X3dShapes shapes(document, appearances, builder);
    X3dNodes nodes(document, shapes, builder);
    builder.result().root.children = nodes.build();
    if (const std::string skipped = document.diagnostics().skipped();
        builder.result().counts.geometries == 0 && !skipped.empty()) {
        throw Error(ErrorCode::InvalidInput,
                    "it has no supported shape (skipped: " + skipped + "): convert them to IndexedFaceSets");
    }
    scene::Background background;
    const bool is_replaced = builder.options().background || !builder.options().environment.empty();
    if (nodes.background() && !is_replaced)
        background = read_background(document, nodes.background(), builder);
    for (const std::string& notice : document.diagnostics().notices()) builder.notice(notice);
    return background;
}

}  // namespace tessera::import
