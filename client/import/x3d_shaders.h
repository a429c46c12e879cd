#pragma once

#include "client/import/x3d_document.h"
#include "client/import/x3d_textures.h"
#include "mediator/scene/materials.h"

namespace tessera::import {

// Nodes that say what things are made of, field by field; what a file leaves out has the value of the scene's
// object, which is that of the thesis. Numbers that the scene does not take are problems of the file.

// CommonSurfaceShader with either spelling: emission or emissive; shininessFactor of one number or two,
// relativeIndexOfRefraction of one or three. Textures hang below it, each with its containerField.
scene::SurfaceShader read_surface_shader(X3dDocument& document, pugi::xml_node node, X3dTextures& textures);

// Material is the same model without perfect speculars: ambient = ambientIntensity x diffuseColor, alpha =
// 1 - transparency.
scene::SurfaceShader read_material(X3dDocument& document, pugi::xml_node node);

// CommonVolumeShader. Its phaseFunction is a node HenyeyGreenstein with the field `anisotropy`, -1 to 1, and
// it has a field `priority`: both are ours, X3D and the thesis name none. Textures of coefficients are
// linear.
scene::Medium read_medium(X3dDocument& document, pugi::xml_node node, X3dTextures& textures);

}  // namespace tessera::import
