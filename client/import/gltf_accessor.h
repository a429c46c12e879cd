#pragma once

#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace tinygltf {
class Model;
}

namespace tessera::import {

// Decodes accessors with full validation: references, component types, offsets, lengths, strides, counts,
// sparse indices. Normalized integers become floats by glTF 3.11, others by value (KHR_mesh_quantization).
// All functions throw Error{InvalidInput} naming the accessor.
class GltfAccessors {
  public:
    explicit GltfAccessors(const tinygltf::Model& model) : model_(model) {}

    std::uint64_t count(int accessor) const;
    std::vector<std::uint32_t> indices(int accessor) const;  // unsigned 8, 16 or 32 bit scalars
    std::vector<float> scalars(int accessor) const;
    std::vector<glm::vec2> vec2(int accessor) const;
    std::vector<glm::vec3> vec3(int accessor) const;
    std::vector<glm::vec4> vec4(int accessor) const;
    std::vector<glm::vec4> color(int accessor) const;      // three or four components; default alpha 1
    std::vector<glm::u16vec4> joints(int accessor) const;  // unsigned 8 or 16 bit, four
    std::vector<glm::dmat4> matrices(int accessor) const;  // float; the last row is taken as 0 0 0 1

    std::span<const unsigned char> view(int buffer_view) const;

  private:
    const tinygltf::Model& model_;
};

}  // namespace tessera::import
