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

// The one buffer of a .glb: appends arrays, aligned to 4 bytes, equal ones once. Throws Error{NotFound} for a
// blob that is not there, Error{InvalidInput} when the buffer grows beyond 3.75 GiB: the rest of a .glb's 4
// is for its text.
class GlbBuffer {
  public:
    GlbBuffer(tinygltf::Model& model, const scene::BlobStore& blobs) : model_(model), blobs_(blobs) {}

    scene::BlobPtr blob(const scene::BlobRef& reference) const;
    int view(std::span<const std::byte> bytes);

    // The number of an accessor for an array of the scene: one of `components` 32-bit elements each.
    enum class Role { Indices, Positions, Other };
    int accessor(const scene::BlobRef& reference, Role role, int components);

  private:
    tinygltf::Model& model_;
    const scene::BlobStore& blobs_;
    std::map<std::tuple<Hash256, Role, int>, int> accessors_;
};

}  // namespace tessera::exporting
