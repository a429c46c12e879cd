#pragma once

#include "mediator/scene/change_list.h"
#include "mediator/scene/scene.h"

namespace tessera::master {

// Whether `changes` may alter samples, so that accumulation must restart; decided only here (design 1.3). `after`
// is the scene with the changes. Names, hints, attachments, cameras (a view has its own by value), transforms that
// contain nothing else, and unreferenced objects do not alter samples. Objects that enter or leave the graph appear as
// a change of the object that refers to them.
bool changes_pictures(const scene::ChangeList& changes, const scene::Scene& after);

}  // namespace tessera::master
