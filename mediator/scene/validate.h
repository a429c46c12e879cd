#pragma once

#include <string>
#include <vector>

#include "mediator/scene/blob.h"
#include "mediator/scene/inverse.h"
#include "mediator/scene/referrers.h"
#include "mediator/scene/scene.h"

namespace tessera::scene {

struct Problem {
    ObjectId id;
    std::string message;  // names object, cause and remedy
};

// Checks the objects alone and against each other: finite numbers, ranges of enums and angles, sizes of
// arrays against each other, references that exist and have the right kind, no cycles, ids below 2^32, one
// Root. Does not look into blobs. Empty = valid.
std::vector<Problem> validate(const Scene& scene);

// Checks only the objects that `entries` touch and those that refer to them; `scene` is the state after them.
std::vector<Problem> validate_entries(const Scene& scene, const std::vector<Entry>& entries);

// The same for `changes`, with an index of `scene`: the cost is that of the changed objects, independent of the size
// of the scene.
std::vector<Problem> validate_changes(const Scene& scene, const ReferrerIndex& referrers,
                                      const std::vector<ObjectChange>& changes);

// Looks into a geometry's or texture's blobs: indices in range, finite positions and normals, enough texels.
// The message gives their number and the first one. Empty = valid. Every node checks received blobs.
std::vector<Problem> validate_blobs(ObjectId id, const Object& object, const BlobStore& blobs);

}  // namespace tessera::scene
