#pragma once

#include "client/import/x3d_document.h"
#include "client/import/x3d_textures.h"
#include "mediator/scene/materials.h"

namespace tessera::import {

// Readers for material nodes. Missing fields have the defaults of the scene objects, which are those of
// Schwenk's thesis. Numbers out of range are reported.

// CommonSurfaceShader with either spelling: emission or emissive; shininessFactor of one number or two,
// relativeIndexOfRefraction of one or three. Textures are children, identified by containerField.
scene::SurfaceShader read_surface_shader(X3dDocument& document, pugi::xml_node node, X3dTextures& textures);

// Material is the same model without perfect speculars: ambient = ambientIntensity x diffuseColor, alpha =
// 1 - transparency.
scene::SurfaceShader read_material(X3dDocument& document, pugi::xml_node node);

// CommonVolumeShader. Its phaseFunction is a node HenyeyGreenstein with the field `anisotropy`, -1 to 1, and
// it has a field `priority`: both are our extensions; neither X3D nor the thesis has them. Textures of
// coefficients are linear.
scene::Medium read_medium(X3dDocument& document, pugi::xml_node node, X3dTextures& textures);

}  // namespace tessera::import
