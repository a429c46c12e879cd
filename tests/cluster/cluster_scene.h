#pragma once

#include <vector>

#include "mediator/scene/blob.h"
#include "mediator/scene/change_list.h"

namespace tessera::test {

// Two triangles that coincide, under one transform. Ids from `first` on; the arrays go to `blobs`.
std::vector<scene::Entry> scene_entries(ObjectId first, scene::BlobStore& blobs);

}  // namespace tessera::test
