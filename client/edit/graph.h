#pragma once

#include <vector>

#include "client/edit/commands.h"
#include "client/edit/rehearsal.h"

// What commands that build the tree share.
namespace tessera::edit {

std::vector<ObjectId>& children_of(scene::Object& object);  // of a Root or a Transform
scene::Entry children_update(ObjectId id,
                             scene::Object object);  // writes the children of a Root or Transform
ObjectId read_parent(const Rehearsal& rehearsal,
                     const Word& path);  // a Root or Transform; throws ScriptError
ObjectId new_id(Rehearsal& rehearsal);   // throws ScriptError

}  // namespace tessera::edit
