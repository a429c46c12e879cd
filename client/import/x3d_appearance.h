#pragma once

#include <glm/mat3x3.hpp>
#include <map>
#include <string>

#include "client/import/scene_builder.h"
#include "client/import/x3d_document.h"
#include "client/import/x3d_textures.h"

namespace tessera::import {

// Whether a geometry has vertex colours, which replace a Material's diffuse colour.
enum class VertexColors { None, Given };

// An Appearance as geometries use it.
struct X3dSurface {
    ObjectId material, medium;
    bool is_textured = false;  // needs texture coordinates
    bool needs_tangents = false;
    glm::dmat3 texture_transform{1.0};  // of (s, t, 1)
};

class X3dAppearances {
  public:
    X3dAppearances(X3dDocument& document, X3dTextures& textures, SceneBuilder& builder)
        : document_(document), textures_(textures), builder_(builder) {}

    // A CommonSurfaceShader replaces Material and ImageTexture, which are then a fallback for other programs.
    // Without shader and Material: the texture or white, unlit.
    X3dSurface surface(pugi::xml_node appearance, VertexColors colors);

  private:
    struct Parts {  // null nodes if absent
        pugi::xml_node shader, volume, material, texture, texture_transform;
    };
    Parts parts_of(pugi::xml_node appearance);
    X3dSurface make(pugi::xml_node appearance, VertexColors colors);
    void add_shader(pugi::xml_node node, X3dSurface& surface);
    void add_material(const Parts& parts, VertexColors colors, X3dSurface& surface);
    void add_unlit(pugi::xml_node appearance, pugi::xml_node texture, X3dSurface& surface);
    ObjectId medium(pugi::xml_node node);

    X3dDocument& document_;
    X3dTextures& textures_;
    SceneBuilder& builder_;
    std::map<std::pair<const void*, VertexColors>, X3dSurface> surfaces_;
    std::map<const void*, X3dSurface> shaders_;
    std::map<const void*, ObjectId> media_;
};

}  // namespace tessera::import
