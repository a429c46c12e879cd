#pragma once

#include <memory>
#include <span>

#include "mediator/backend/tables/tables.h"
#include "tests/backend/scene_builder.h"

namespace tessera::test {

// A scene that is built step by step, with everything needed for its tables.
struct TablesFixture {
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    backend::MeshCatalog meshes{blobs};
    SceneBuilder builder;
    backend::ShadowScene shadow;
    backend::MipmapCache mipmaps;

    template <class Array>
    scene::BlobRef blob(const Array& values) {
        return scene::reference(*blobs->insert(std::as_bytes(std::span(values))));
    }
    // All tables of the current scene.
    backend::SceneTables make_all() {
        return backend::make_tables(shadow.scene(), shadow.flat_scene(), meshes, *blobs, mipmaps);
    }
};

}  // namespace tessera::test
