#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/import/deform.h"
#include "client/import/node_motion.h"
#include "mediator/base/ids.h"

namespace tessera::import {

// A geometry that is deformed again at other times.
struct DeformedGeometry {
    ObjectId geometry;
    std::string name;
    std::shared_ptr<const DeformableMesh> mesh;
    int node = -1;  // the node with the mesh
    int skin = -1;
};

// What move_to needs of a file.
struct Playback {
    NodeMotion motion;
    std::vector<ObjectId> transforms;  // of each node; 0 = none
    std::vector<Skin> skins;
    std::vector<DeformedGeometry> deformed;
};

}  // namespace tessera::import
