#pragma once

#include <map>

#include "client/import/x3d_appearance.h"

namespace tessera::import {

// Creates Geometry objects from Shape nodes: one per geometry node and Appearance, so that geometry shared by
// USE stays shared. An invalid mesh is reported and replaced by a magenta box.
class X3dShapes {
  public:
    X3dShapes(X3dDocument& document, X3dAppearances& appearances, SceneBuilder& builder)
        : document_(document), appearances_(appearances), builder_(builder) {}

    ObjectId geometry(pugi::xml_node shape);  // 0 if it has no supported geometry

  private:
    ObjectId make(pugi::xml_node shape, pugi::xml_node geometry, pugi::xml_node appearance);

    X3dDocument& document_;
    X3dAppearances& appearances_;
    SceneBuilder& builder_;
    std::map<std::pair<const void*, const void*>, ObjectId> geometries_;  // by geometry and appearance
};

}  // namespace tessera::import
