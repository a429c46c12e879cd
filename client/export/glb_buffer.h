#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <tuple>

#include "mediator/base/hash.h"
#include "mediator/scene/blob.h"

namespace tinygltf {
class Model;
}

namespace tessera::exporting {

// The single buffer of a .glb: appends arrays, aligned to 4 bytes, equal ones once. Throws Error{NotFound}
// for a missing blob, Error{InvalidInput} if the buffer exceeds 3.75 GiB: the rest of a .glb's 4 GiB is for
// its JSON.
class GlbBuffer {
  public:
    GlbBuffer(tinygltf::Model& model, const scene::BlobStore& blobs) : model_(model), blobs_(blobs) {}

    scene::BlobPtr blob(const scene::BlobRef& reference) const;
    int view(std::span<const std::byte> bytes);

    // The index of an accessor for an array of the scene with `components` 32-bit components per element.
    enum class Role { Indices, Positions, Other };
    int accessor(const scene::BlobRef& reference, Role role, int components);

  private:
    tinygltf::Model& model_;
    const scene::BlobStore& blobs_;
    std::map<std::tuple<Hash256, Role, int>, int> accessors_;
};

}  // namespace tessera::exporting
