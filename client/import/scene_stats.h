#pragma once

#include <vector>

#include "client/import/emissive_lights.h"

namespace tessera::import {

struct LightInstance {
    ObjectId id;
    glm::dmat4 world{1.0};
};

// Statistics of the complete graph.
struct SceneStats {
    Bounds bounds;                      // world bounds of all instances
    std::vector<CameraInfo> cameras;    // by object id, that is in file order
    std::vector<LightInstance> lights;  // all instances
    EmissiveLights emissive_lights;     // of all instances of emissive geometries
};

// Sets the counts of instances, lights and emissive geometries. Removes geometries from transforms all of
// whose instances are degenerate or not finite, with a notice, and lists them under without_volume. If a
// camera has several instances, the first is used. Throws if there are too many instances. The graph must
// have no cycles.
SceneStats gather_scene_stats(SceneBuilder& builder);

// Whether a lit material, surface shader or medium has emission; false for other objects.
bool emits(const scene::Object& shading_object);

// Whether the matrix is invertible within floating-point range.
bool has_volume(const glm::dmat4& matrix);

// Reduces a transform to its rigid part, by its view direction (-z) and up (y). False if it is degenerate.
bool make_rigid(glm::dmat4& matrix);

}  // namespace tessera::import
