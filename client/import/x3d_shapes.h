#pragma once

#include <map>

#include "client/import/x3d_appearance.h"

namespace tessera::import {

// Makes Geometry objects of Shape nodes: one per geometry node and Appearance, so that what a file shares by
// USE stays shared. A bad mesh is a magenta box and a problem.
class X3dShapes {
  public:
    X3dShapes(X3dDocument& document, X3dAppearances& appearances, SceneBuilder& builder)
        : document_(document), appearances_(appearances), builder_(builder) {}

    ObjectId geometry(pugi::xml_node shape);  // 0 when it has none that is read

  private:
    ObjectId make(pugi::xml_node shape, pugi::xml_node geometry, pugi::xml_node appearance);

    X3dDocument& document_;
    X3dAppearances& appearances_;
    SceneBuilder& builder_;
    std::map<std::pair<const void*, const void*>, ObjectId> made_;  // by geometry and appearance
};

}  // namespace tessera::import
