#pragma once

#include <vector>

#include "client/edit/commands.h"
#include "client/edit/dry_run.h"

// Helpers of the commands that edit the scene hierarchy.
namespace tessera::edit {

std::vector<ObjectId>& children_of(scene::Object& object);  // of a Root or a Transform
scene::Entry children_update(ObjectId id,
                             scene::Object object);  // writes the children of a Root or Transform
ObjectId read_parent(const DryRun& dry_run,
                     const Word& path);  // a Root or Transform; throws ScriptError
ObjectId new_id(DryRun& dry_run);        // throws ScriptError

}  // namespace tessera::edit
