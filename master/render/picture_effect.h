#pragma once

#include "mediator/scene/change_list.h"
#include "mediator/scene/scene.h"

namespace tessera::master {

// What an edit may do to pictures. Temporal filters trust their history accordingly.
struct PictureEffect {
    bool samples = false;              // they differ: accumulation must restart
    bool lights_or_materials = false;  // radiance may differ anywhere
    bool geometry = false;             // surfaces may have moved
};

// The effect of `changes`; decided only here (design 1.3). `after` is the scene with the changes. Names, hints,
// attachments, cameras (a view has its own by value), transforms that contain nothing else, and unreferenced objects do
// not alter samples. Objects that enter or leave the graph appear as a change of the object that refers to them; what
// left is unknown and may have been a light.
PictureEffect picture_effect(const scene::ChangeList& changes, const scene::Scene& after);

}  // namespace tessera::master
