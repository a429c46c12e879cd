#pragma once

#include "mediator/scene/change_list.h"
#include "mediator/scene/scene.h"

namespace tessera::master {

// Whether samples taken before `changes` may differ from those after, so that accumulation starts again: the
// one place that decides it (design 1.3). `after` is the scene with the changes. Names, hints, attachments,
// cameras (a view has its own by value), the transforms of nothing but these, and objects that nothing refers
// to change no sample; what comes into or leaves the graph shows as a change of who refers to it.
bool changes_pictures(const scene::ChangeList& changes, const scene::Scene& after);

}  // namespace tessera::master
