#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/scene/scene.h"

namespace tessera::backend {

// The deep graph made flat (Schwenk 5.4.1): at most one transform above a geometry, sharing kept. Ordered by
// object ids along the path from the root, never by history, so that equal scenes lower to equal tables.
struct Instance {
    ObjectId geometry;
    glm::dmat4 world_from_object{1.0};
    scene::MotionHint hint =
        scene::MotionHint::Unflagged;          // of the geometry or the nearest flagged transform
    std::uint32_t layers = scene::RootLayers;  // never 0
    std::vector<ObjectId> path;                // transforms from the root down
    std::vector<glm::dmat4> motion;            // world_from_object at even steps of time after the first
};

struct PlacedLight {
    ObjectId light;
    glm::dmat4 world_from_light{1.0};
    std::uint32_t layers = scene::RootLayers;  // never 0
    std::vector<ObjectId> path;
    std::vector<glm::dmat4> motion;
};

struct Lowered {
    std::vector<Instance> instances;  // by (geometry, path)
    std::vector<PlacedLight> lights;  // by (light, path)
};

// InvalidInput for a cycle below the root, for a graph deeper than MaxDepth, or when instances and lights
// exceed `limit`; a missing child is skipped (validation tells of it), and a child named twice by one parent
// is there once.
inline constexpr std::size_t MaxDepth = 1024;
Expected<Lowered> lower(const scene::Scene& scene, std::size_t limit = 16'000'000);

// The product of the transforms along a path: what `lower` computes, to the bit.
glm::dmat4 placement(const scene::Scene& scene, std::span<const ObjectId> path);

}  // namespace tessera::backend
