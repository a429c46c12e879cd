#pragma once

#include <memory>

#include "mediator/scene/change_list.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::tools::bench {

// A bench scene and its edits, in order: the whole scene, a deformation of its largest mesh (marked as
// animated), and a movement of that mesh.
struct EditedScene {
    BenchScene scene;
    std::shared_ptr<scene::BlobStore> blobs;
    scene::ChangeList snapshot, deformation, movement;
    std::uint64_t triangles = 0, instances = 0;
};

// Throws Error{InvalidInput} for a scene without meshes.
EditedScene with_edits(BenchScene scene);

}  // namespace tessera::tools::bench
