#pragma once

#include <glm/mat3x3.hpp>
#include <map>
#include <tuple>

#include "client/import/scene_builder.h"
#include "client/import/x3d_document.h"
#include "client/import/x3d_textures.h"

namespace tessera::import {

// What the geometry that is drawn with an Appearance says about it.
struct X3dSides {
    bool solid = true;        // only its front is there
    bool has_colors = false;  // for each vertex; they take the place of a Material's diffuse colour
    friend auto operator<=>(const X3dSides&, const X3dSides&) = default;
};

// An Appearance as geometries use it.
struct X3dSurface {
    ObjectId material;
    bool is_textured = false;  // needs texture coordinates
    bool wants_tangents = false;
    glm::dmat3 texture_transform{1.0};  // of (s, t, 1)
};

class X3dAppearances {
  public:
    X3dAppearances(X3dDocument& document, X3dTextures& textures, SceneBuilder& builder)
        : document_(document), textures_(textures), builder_(builder) {}

    // Without an Appearance, or with one without a Material: white or the picture, unlit.
    X3dSurface surface(pugi::xml_node appearance, X3dSides sides);

  private:
    X3dSurface make(pugi::xml_node appearance, X3dSides sides);

    X3dDocument& document_;
    X3dTextures& textures_;
    SceneBuilder& builder_;
    std::map<std::pair<const void*, X3dSides>, X3dSurface> made_;
};

}  // namespace tessera::import
