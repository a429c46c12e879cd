#pragma once

#include <memory>
#include <span>

#include "mediator/backend/tables/tables.h"
#include "tests/backend/scene_builder.h"

namespace tessera::test {

// A scene that is built step by step, and what tables are made of.
struct TablesStage {
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    backend::MeshCatalog meshes{blobs};
    SceneBuilder builder;
    backend::ShadowScene shadow;
    backend::TexturePyramids pyramids;

    template <class Array>
    scene::BlobRef blob(const Array& values) {
        return scene::reference(*blobs->insert(std::as_bytes(std::span(values))));
    }
    // All of them, as the scene is now.
    backend::SceneTables make_all() {
        return backend::make_tables(shadow.scene(), shadow.lowered(), meshes, *blobs, pyramids);
    }
};

}  // namespace tessera::test
