#pragma once

#include "mediator/scene/materials.h"

namespace tessera::exporting {

// The glTF material that is most similar to a surface shader, for programs without surface shaders. Glossy
// and perfect reflection become a metallic fraction, which preserves the energy of each lobe at normal
// incidence for grey colours. Not preserved: separate specular colours, dispersion, and textures other than
// those of the diffuse lobe, emission and normals.
scene::Material nearest_material(const scene::SurfaceShader& shader);

}  // namespace tessera::exporting
