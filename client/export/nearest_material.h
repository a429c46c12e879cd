#pragma once

#include "mediator/scene/materials.h"

namespace tessera::exporting {

// The material of glTF that looks most like a surface shader, for programs that know none. What reflects
// beside the diffuse lobe, glossy or perfect, is a share of metal, so that light that comes straight on goes
// the same ways in the same amounts where colours are grey; the rest of the shader's look is not kept:
// colours of highlights of their own, textures but those of the diffuse lobe, emission and normals,
// dispersion.
scene::Material nearest_material(const scene::SurfaceShader& shader);

}  // namespace tessera::exporting
