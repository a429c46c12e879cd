#pragma once

#include <vector>

#include "mediator/scene/blob.h"
#include "mediator/scene/change_list.h"

namespace tessera::test {

// Two coincident triangles under one transform. Ids from `first` on; the arrays are put into `blobs`.
std::vector<scene::Entry> scene_entries(ObjectId first, scene::BlobStore& blobs);

}  // namespace tessera::test
