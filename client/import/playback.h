#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/import/deform.h"
#include "client/import/node_motion.h"
#include "mediator/base/ids.h"

namespace tessera::import {

// What is bent again at other times.
struct BendingGeometry {
    ObjectId geometry;
    std::string name;
    std::shared_ptr<const BendingMesh> mesh;
    int node = -1;  // with the mesh
    int skin = -1;
};

// All that move_to needs of a file.
struct Playback {
    NodeMotion motion;
    std::vector<ObjectId> transforms;  // of each node; 0 where none follows it
    std::vector<Skin> skins;
    std::vector<BendingGeometry> bending;
};

}  // namespace tessera::import
