#pragma once

#include <string>
#include <vector>

#include "master/scene/edit_history.h"
#include "mediator/scene/scene.h"

namespace tessera::master {

// The edit that undoes a transaction in the current scene.
struct UndoPlan {
    std::vector<scene::Entry> entries;
    // The writer of each restored field; the undo's author where lists of children were merged.
    std::map<ObjectId, ObjectWriters> writers;
    std::vector<std::string> notes;  // fields that stay since others changed them, and who
};

// Fields whose last writer is the transaction get their previous values; fields that others wrote since stay. Lists of
// children that others wrote since are merged: children that the transaction added are removed, those that it removed
// are reinserted at their position. Removed objects are restored with their ids and writers; created ones removed.
UndoPlan plan_undo(const Transaction& transaction, const scene::Scene& scene, const WriterTable& writers,
                   const EditHistory& history, const WriterPtr& author);

// `now` without the change from `before` to `after`. Reinserted ids follow the id that preceded them before.
std::vector<ObjectId> without_change(const std::vector<ObjectId>& before, const std::vector<ObjectId>& after,
                                     const std::vector<ObjectId>& now);

}  // namespace tessera::master
