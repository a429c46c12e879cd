#pragma once

#include "mediator/scene/blob.h"
#include "mediator/scene/scene.h"

// A small valid scene with all features: all kinds, all three light types, every field of a material
// different from its default, shared transforms, byte and float textures, attachments, names that are invalid
// as file names. Ids are consecutive from 2.
namespace tessera::exporting {

struct RichScene {
    scene::Scene scene;
    scene::BlobStore blobs;
};

void make_rich(RichScene& to);

}  // namespace tessera::exporting
