#pragma once

#include <string>
#include <vector>

#include "master/scene/edit_history.h"
#include "mediator/scene/scene.h"

namespace tessera::master {

// What takes a transaction back from the scene as it is now.
struct UndoPlan {
    std::vector<scene::Entry> entries;
    // The writer of each field that it brings back; the undo's own where lists of children were merged.
    std::map<ObjectId, ObjectWriters> writers;
    std::vector<std::string> notes;  // what stays as others made it since, and who that was
};

// Fields whose last writer still is the transaction become what they were before it; fields that others wrote
// since stay. Lists of children that others wrote since are merged: what the transaction added goes, what it
// removed comes back at its place. Removed objects come back under their ids, with their writers; created
// ones go.
UndoPlan plan_undo(const Transaction& transaction, const scene::Scene& scene, const WriterTable& writers,
                   const EditHistory& history, const WriterPtr& author);

// `now` without what led from `before` to `after`. Of what was taken out and comes back, each follows what it
// stood behind.
std::vector<ObjectId> without_step(const std::vector<ObjectId>& before, const std::vector<ObjectId>& after,
                                   const std::vector<ObjectId>& now);

}  // namespace tessera::master
