#pragma once

#include <vector>

#include "client/import/glow.h"

namespace tessera::import {

// What a walk over the finished graph finds.
struct Survey {
    Bounds bounds;                    // of all geometries as placed
    std::vector<CameraInfo> cameras;  // by object id, that is in file order
    Glow glow;                        // of all emissive geometries as placed
};

// Fills the counts of instances, lights and emissive geometries. Takes geometries out of transforms that
// leave them without volume or are not finite wherever they stand (nothing could be seen or inverted), with a
// notice, and lists them under without_volume. Of a camera that stands in several places the first counts.
// Throws when there are too many instances or too many places of transforms. The graph below the root must
// have no cycles.
Survey survey(SceneBuilder& builder);

// Of a material that is lit, a surface shader or a medium; other objects do not.
bool emits(const scene::Object& made_of);

// Whether what is placed so has a volume, and its inverse one that numbers can tell.
bool has_volume(const glm::dmat4& matrix);

// The rigid part of a transform: where it looks (-z) and what is up (y). False when it has none.
bool make_rigid(glm::dmat4& matrix);

}  // namespace tessera::import
