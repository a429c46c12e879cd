#include "client/import/gltf_accessor.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "client/import/limits.h"
#include "mediator/base/error.h"

namespace tessera::import {
namespace {

// `count` elements of `element_size` bytes, `stride` apart; all within `bytes`.
struct Elements {
    std::span<const unsigned char> bytes;
    std::size_t stride = 0;
    const unsigned char* at(std::size_t i) const { return bytes.data() + i * stride; }
};

[[noreturn]] void reject_accessor(int accessor, const std::string& cause) {
    throw Error(ErrorCode::InvalidInput, "accessor " + std::to_string(accessor) + " " + cause);
}

const tinygltf::Accessor& find(const tinygltf::Model& model, int accessor) {
    if (accessor < 0 || static_cast<std::size_t>(accessor) >= model.accessors.size()) {
        reject_accessor(accessor, "is missing: there are " + std::to_string(model.accessors.size()));
    }
    return model.accessors[static_cast<std::size_t>(accessor)];
}

std::size_t component_size(int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

std::size_t component_count(int type) {
    switch (type) {
        case TINYGLTF_TYPE_SCALAR:
            return 1;
        case TINYGLTF_TYPE_VEC2:
            return 2;
        case TINYGLTF_TYPE_VEC3:
            return 3;
        case TINYGLTF_TYPE_VEC4:
            return 4;
        case TINYGLTF_TYPE_MAT4:
            return 16;
        default:
            return 0;
    }
}

template <class T>
T load(const unsigned char* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

float component(const unsigned char* from, int type, bool normalized) {
    const auto signed_value = [&](float value, float largest) {
        return normalized ? std::max(value / largest, -1.0f) : value;
    };
    const auto unsigned_value = [&](float value, float largest) {
        return normalized ? value / largest : value;
    };
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return signed_value(load<std::int8_t>(from), 127.0f);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return unsigned_value(load<std::uint8_t>(from), 255.0f);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return signed_value(load<std::int16_t>(from), 32767.0f);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return unsigned_value(load<std::uint16_t>(from), 65535.0f);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return static_cast<float>(load<std::uint32_t>(from));
        default:
            return load<float>(from);
    }
}

std::uint32_t index_component(const unsigned char* from, int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load<std::uint8_t>(from);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<std::uint16_t>(from);
        default:
            return load<std::uint32_t>(from);
    }
}

bool is_index_type(int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

Elements elements(const GltfAccessors& accessors, const tinygltf::Model& model, int accessor, int buffer_view,
                  std::uint64_t offset, std::uint64_t count, std::uint64_t element_size) {
    const std::span<const unsigned char> bytes = accessors.view(buffer_view);
    std::uint64_t stride = model.bufferViews[static_cast<std::size_t>(buffer_view)].byteStride;
    if (stride == 0) stride = element_size;
    if (stride < element_size) reject_accessor(accessor, "has a stride smaller than its elements");
    // count <= MaxElements and stride <= 252, so nothing here can overflow.
    if (count > MaxElements || offset > bytes.size() ||
        (count > 0 && (count - 1) * stride + element_size > bytes.size() - offset)) {
        reject_accessor(accessor, "needs " + std::to_string(count) + " elements from a buffer view of " +
                                      std::to_string(bytes.size()) + " bytes");
    }
    return {bytes.subspan(offset), stride};
}

std::vector<float> decode(const GltfAccessors& accessors, const tinygltf::Model& model, int index,
                          std::size_t components) {
    const tinygltf::Accessor& accessor = find(model, index);
    const std::size_t size = component_size(accessor.componentType);
    if (size == 0) reject_accessor(index, "has an unknown component type");
    if (component_count(accessor.type) != components) {
        reject_accessor(
            index, "does not have the " + std::to_string(components) + " components that its use requires");
    }
    const bool backed = accessor.bufferView >= 0;
    if (accessor.count > (backed ? MaxElements : MaxUnbackedElements)) {
        reject_accessor(index, "claims " + std::to_string(accessor.count) + " elements");
    }
    const std::size_t element_size = size * components;
    const auto convert = [&](const unsigned char* from, float* to) {
        for (std::size_t k = 0; k < components; ++k) {
            to[k] = component(from + k * size, accessor.componentType, accessor.normalized);
        }
    };
    Elements source;
    if (backed) {  // checked before allocating by a count from the file
        source = elements(accessors, model, index, accessor.bufferView, accessor.byteOffset, accessor.count,
                          element_size);
    }
    std::vector<float> values(accessor.count * components, 0.0f);
    for (std::size_t i = 0; backed && i < accessor.count; ++i) convert(source.at(i), &values[i * components]);
    if (!accessor.sparse.isSparse) return values;

    const auto& sparse = accessor.sparse;
    if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > accessor.count ||
        !is_index_type(sparse.indices.componentType) || sparse.indices.byteOffset < 0 ||
        sparse.values.byteOffset < 0) {
        reject_accessor(index, "has an invalid sparse part");
    }
    const auto count = static_cast<std::size_t>(sparse.count);
    const Elements replaced = elements(accessors, model, index, sparse.indices.bufferView,
                                       static_cast<std::uint64_t>(sparse.indices.byteOffset), count,
                                       component_size(sparse.indices.componentType));
    const Elements replacements =
        elements(accessors, model, index, sparse.values.bufferView,
                 static_cast<std::uint64_t>(sparse.values.byteOffset), count, element_size);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t element = index_component(replaced.at(i), sparse.indices.componentType);
        if (element >= accessor.count)
            reject_accessor(index, "has a sparse index " + std::to_string(element) + " that is out of range");
        convert(replacements.at(i), &values[element * components]);
    }
    return values;
}

template <class Vector>
std::vector<Vector> vectors(const std::vector<float>& values) {
    constexpr std::size_t N = Vector::length();
    std::vector<Vector> result(values.size() / N);
    for (std::size_t i = 0; i < result.size(); ++i) {
        for (std::size_t k = 0; k < N; ++k) result[i][static_cast<int>(k)] = values[i * N + k];
    }
    return result;
}

}  // namespace

std::span<const unsigned char> GltfAccessors::view(int buffer_view) const {
    if (buffer_view < 0 || static_cast<std::size_t>(buffer_view) >= model_.bufferViews.size()) {
        throw Error(ErrorCode::InvalidInput, "buffer view " + std::to_string(buffer_view) + " is missing");
    }
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(buffer_view)];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model_.buffers.size()) {
        throw Error(ErrorCode::InvalidInput, "buffer " + std::to_string(view.buffer) + " is missing");
    }
    const std::vector<unsigned char>& buffer = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
        throw Error(ErrorCode::InvalidInput, "buffer view " + std::to_string(buffer_view) +
                                                 " extends beyond its buffer of " +
                                                 std::to_string(buffer.size()) + " bytes");
    }
    return std::span(buffer).subspan(view.byteOffset, view.byteLength);
}

std::uint64_t GltfAccessors::count(int accessor) const {
    return find(model_, accessor).count;
}

std::vector<std::uint32_t> GltfAccessors::indices(int index) const {
    const tinygltf::Accessor& accessor = find(model_, index);
    if (!is_index_type(accessor.componentType) || accessor.type != TINYGLTF_TYPE_SCALAR) {
        reject_accessor(index, "is used for indices, but holds no unsigned integers");
    }
    if (accessor.sparse.isSparse || accessor.bufferView < 0)
        reject_accessor(index, "holds indices without a buffer view");
    const std::size_t size = component_size(accessor.componentType);
    const Elements source =
        elements(*this, model_, index, accessor.bufferView, accessor.byteOffset, accessor.count, size);
    std::vector<std::uint32_t> values(accessor.count);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = index_component(source.at(i), accessor.componentType);
    }
    return values;
}

std::vector<float> GltfAccessors::scalars(int accessor) const {
    return decode(*this, model_, accessor, 1);
}
std::vector<glm::vec2> GltfAccessors::vec2(int accessor) const {
    return vectors<glm::vec2>(decode(*this, model_, accessor, 2));
}
std::vector<glm::vec3> GltfAccessors::vec3(int accessor) const {
    return vectors<glm::vec3>(decode(*this, model_, accessor, 3));
}
std::vector<glm::vec4> GltfAccessors::vec4(int accessor) const {
    return vectors<glm::vec4>(decode(*this, model_, accessor, 4));
}
std::vector<glm::vec4> GltfAccessors::color(int accessor) const {
    if (find(model_, accessor).type != TINYGLTF_TYPE_VEC3) return vec4(accessor);
    std::vector<glm::vec4> colors;
    for (const glm::vec3& color : vec3(accessor)) colors.emplace_back(color, 1.0f);
    return colors;
}

std::vector<glm::u16vec4> GltfAccessors::joints(int index) const {
    const tinygltf::Accessor& accessor = find(model_, index);
    const int type = accessor.componentType;
    if (accessor.normalized ||
        (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)) {
        reject_accessor(index, "is used for joints, but holds no unsigned 8 or 16 bit integers");
    }
    std::vector<glm::u16vec4> joints;
    for (const glm::vec4& four : vec4(index)) joints.emplace_back(four);  // floats hold 16 bits exactly
    return joints;
}

std::vector<glm::dmat4> GltfAccessors::matrices(int index) const {
    if (find(model_, index).componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
        reject_accessor(index, "is used for matrices, but holds no floats");
    const std::vector<float> values = decode(*this, model_, index, 16);
    std::vector<glm::dmat4> matrices(values.size() / 16, glm::dmat4(1.0));
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto column = static_cast<int>(i % 16 / 4), row = static_cast<int>(i % 4);
        if (row < 3) matrices[i / 16][column][row] = double(values[i]);
    }
    return matrices;
}

}  // namespace tessera::import
