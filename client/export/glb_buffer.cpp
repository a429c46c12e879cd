#include "client/export/glb_buffer.h"

#include <tiny_gltf.h>

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>

#include "mediator/base/error.h"

namespace tessera::exporting {
namespace {

constexpr std::size_t MaxBufferBytes = 0xf0000000;

}  // namespace

scene::BlobPtr GlbBuffer::blob(const scene::BlobRef& reference) const {
    scene::BlobPtr blob = blobs_.find(reference.hash);
    if (!blob) {
        throw Error(ErrorCode::NotFound,
                    "the bytes of blob " + to_hex(reference.hash) + " are missing: load the scene again");
    }
    return blob;
}

int GlbBuffer::view(std::span<const std::byte> bytes) {
    if (model_.buffers.empty()) model_.buffers.emplace_back();
    std::vector<unsigned char>& data = model_.buffers[0].data;
    data.resize((data.size() + 3) / 4 * 4);
    if (data.size() + bytes.size() > MaxBufferBytes) {
        throw Error(ErrorCode::InvalidInput,
                    "the scene takes more than the 4 GiB of a .glb: save it as .tessera, or split it");
    }
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = bytes.size();
    const auto* first = reinterpret_cast<const unsigned char*>(bytes.data());
    data.insert(data.end(), first, first + bytes.size());
    model_.bufferViews.push_back(std::move(view));
    return static_cast<int>(model_.bufferViews.size()) - 1;
}

int GlbBuffer::accessor(const scene::BlobRef& reference, Role role, int components) {
    const auto [entry, is_new] = accessors_.try_emplace({reference.hash, role, components}, 0);
    if (!is_new) return entry->second;
    const scene::BlobPtr content = blob(reference);
    tinygltf::Accessor accessor;
    accessor.bufferView = view(content->bytes());
    accessor.count = content->bytes().size() / (4 * static_cast<std::size_t>(components));
    accessor.type = components == 1 ? TINYGLTF_TYPE_SCALAR : components;  // VEC2 to VEC4 are 2 to 4
    accessor.componentType =
        role == Role::Indices ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT : TINYGLTF_COMPONENT_TYPE_FLOAT;
    tinygltf::BufferView& bytes = model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    bytes.target =
        role == Role::Indices ? TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER : TINYGLTF_TARGET_ARRAY_BUFFER;
    if (role == Role::Positions) {
        glm::vec3 lower(std::numeric_limits<float>::max()), upper(std::numeric_limits<float>::lowest());
        for (const glm::vec3& point : content->as<glm::vec3>()) {
            lower = glm::min(lower, point);
            upper = glm::max(upper, point);
        }
        accessor.minValues = {lower.x, lower.y, lower.z};
        accessor.maxValues = {upper.x, upper.y, upper.z};
    }
    model_.accessors.push_back(std::move(accessor));
    return entry->second = static_cast<int>(model_.accessors.size()) - 1;
}

}  // namespace tessera::exporting
