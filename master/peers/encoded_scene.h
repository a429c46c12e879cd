#pragma once

#include <cstdint>

#include "mediator/base/ids.h"
#include "mediator/scene/blob.h"

namespace tessera::master {

// A change list as nodes and clients receive it; see scene/scene_encoder.h.
struct EncodedScene {
    std::uint64_t job = 0;
    Version from, to;
    scene::BlobPtr blob;  // null: there was no memory for it
};

}  // namespace tessera::master
