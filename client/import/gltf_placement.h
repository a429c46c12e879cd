#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "mediator/base/error.h"
#include "mediator/scene/objects.h"

namespace tinygltf {
class Node;
struct Camera;
struct Light;
}  // namespace tinygltf

namespace tessera::import {

// Converts nodes, lights and cameras; InvalidInput says what is wrong, without naming the object.

// Translation x rotation (a quaternion x, y, z, w of any length) x scale.
Expected<glm::dmat4> placement(const glm::dvec3& translation, const glm::dvec4& rotation,
                               const glm::dvec3& scale);

// The node's matrix, or that of its translation, rotation and scale.
Expected<glm::dmat4> node_matrix(const tinygltf::Node& node);

// The mask "tessera_layers" of its extras; 0 if there is none.
Expected<std::uint32_t> node_layers(const tinygltf::Node& node);

Expected<scene::Light> punctual_light(const tinygltf::Light& light);
Expected<scene::Camera> camera_of(const tinygltf::Camera& camera);

}  // namespace tessera::import
