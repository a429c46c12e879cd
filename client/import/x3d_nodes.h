#pragma once

#include <map>
#include <vector>

#include "client/import/x3d_shapes.h"

namespace tessera::import {

// Builds the graph below a Scene: Transforms and Groups become Transforms; a node that the file shares by USE
// is built once and has several parents.
class X3dNodes {
  public:
    X3dNodes(X3dDocument& document, X3dShapes& shapes, SceneBuilder& builder)
        : document_(document), shapes_(shapes), builder_(builder) {}

    std::vector<ObjectId> build();
    pugi::xml_node background() const { return background_; }  // the first of the file; null if it has none

  private:
    struct Subtree {
        ObjectId id;             // 0 = nothing to render
        std::size_t height = 0;  // levels of transforms
    };

    Subtree node(pugi::xml_node node, std::size_t depth);
    Subtree group(pugi::xml_node node, std::size_t depth);
    Subtree light(pugi::xml_node node);
    Subtree viewpoint(pugi::xml_node node);
    Subtree with_transform(std::string name, const glm::dmat4& matrix, ObjectId child);

    X3dDocument& document_;
    X3dShapes& shapes_;
    SceneBuilder& builder_;
    std::map<const void*, Subtree> subtrees_;
    pugi::xml_node background_;
};

}  // namespace tessera::import
