#pragma once

#include <memory>

#include "mediator/scene/change_list.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::tools::bench {

// A bench scene and what is edited of it, one list after the other: its largest mesh, which is animated here,
// moves in its vertices and then as a whole.
struct EditedScene {
    BenchScene scene;
    std::shared_ptr<scene::BlobStore> blobs;
    scene::ChangeList everything, vertices, place;
    std::uint64_t triangles = 0, instances = 0;
};

// Throws Error{InvalidInput} for a scene without meshes.
EditedScene with_edits(BenchScene scene);

}  // namespace tessera::tools::bench
