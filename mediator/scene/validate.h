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

// Only what `entries` touch and the objects that refer to it; `scene` is the state after them. Cost is
// theirs.
std::vector<Problem> validate_entries(const Scene& scene, const std::vector<Entry>& entries);

// The same for what `changes` did, told by an index of `scene`: at the cost of the changed objects, whatever
// the size of the scene.
std::vector<Problem> validate_changes(const Scene& scene, const ReferrerIndex& referrers,
                                      const std::vector<ObjectChange>& changes);

// Looks into a geometry's or texture's blobs: indices in range, finite positions and normals, enough texels.
// The message says how many and the first. Empty = valid. Every node runs it on what the network brought.
std::vector<Problem> validate_blobs(ObjectId id, const Object& object, const BlobStore& blobs);

}  // namespace tessera::scene
