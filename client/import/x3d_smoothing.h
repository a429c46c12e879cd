#pragma once

#include "client/import/x3d_face_set.h"

namespace tessera::import {

// Gives every corner a normal, as mesh_of describes. The crease angle must be greater than 0.
void add_smooth_normals(FaceSet& faces);

}  // namespace tessera::import
