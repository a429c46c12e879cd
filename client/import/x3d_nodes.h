#pragma once

#include <map>
#include <vector>

#include "client/import/x3d_shapes.h"

namespace tessera::import {

// Makes the graph below a Scene: Transforms and Groups become Transforms, what a file shares by USE is made
// once and hangs in several places.
class X3dNodes {
  public:
    X3dNodes(X3dDocument& document, X3dShapes& shapes, SceneBuilder& builder)
        : document_(document), shapes_(shapes), builder_(builder) {}

    std::vector<ObjectId> build();
    pugi::xml_node background() const { return background_; }  // the file's first; null without

  private:
    struct Made {
        ObjectId id;             // 0 = nothing to see
        std::size_t height = 0;  // transforms from here down
    };

    Made node(pugi::xml_node node, std::size_t depth);
    Made group(pugi::xml_node node, std::size_t depth);
    Made light(pugi::xml_node node);
    Made viewpoint(pugi::xml_node node);
    Made placed(std::string name, const glm::dmat4& matrix, ObjectId child);

    X3dDocument& document_;
    X3dShapes& shapes_;
    SceneBuilder& builder_;
    std::map<const void*, Made> made_;
    pugi::xml_node background_;
};

}  // namespace tessera::import
