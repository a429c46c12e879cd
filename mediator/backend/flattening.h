#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/scene/graph_size.h"
#include "mediator/scene/scene.h"

namespace tessera::backend {

// The flattened scene graph (Schwenk 5.4.1): one transform per instance, geometries stay shared. Ordered by object
// ids along the path from the root, independent of the edit history, so that equal scenes give equal tables.
struct Instance {
    ObjectId geometry;
    glm::dmat4 world_from_object{1.0};
    scene::MotionHint hint =
        scene::MotionHint::Unflagged;          // of the geometry or the nearest flagged transform
    std::uint32_t layers = scene::RootLayers;  // never 0
    std::vector<ObjectId> path;                // transforms from the root down
    std::vector<glm::dmat4> motion;            // further motion keys of world_from_object, at even times
};

struct PlacedLight {
    ObjectId light;
    glm::dmat4 world_from_light{1.0};
    std::uint32_t layers = scene::RootLayers;  // never 0
    std::vector<ObjectId> path;
    std::vector<glm::dmat4> motion;
};

struct FlatScene {
    std::vector<Instance> instances;  // by (geometry, path)
    std::vector<PlacedLight> lights;  // by (light, path)
};

// InvalidInput for what scene::GraphSize refuses, with `limit` instances and lights. A missing child is skipped
// (validation reports it); a child that a parent lists twice counts once.
Expected<FlatScene> flatten(const scene::Scene& scene, std::size_t limit = scene::MaxPlacements);

// The product of the transforms along a path, bit-identical to that of `flatten`.
glm::dmat4 placement(const scene::Scene& scene, std::span<const ObjectId> path);

}  // namespace tessera::backend
