#pragma once

#include "mediator/scene/blob.h"
#include "mediator/scene/scene.h"

// A small valid scene that has everything: all kinds, all three lights, every field of a material off its
// default, shared transforms, byte and float maps, attachments, names that no file system would like. Ids are
// consecutive from 2.
namespace tessera::exporting {

struct RichScene {
    scene::Scene scene;
    scene::BlobStore blobs;
};

void make_rich(RichScene& to);

}  // namespace tessera::exporting
