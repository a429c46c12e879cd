#pragma once

#include <array>
#include <vector>

#include "client/session.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/change_list.h"

namespace tessera::test {

// A room with two lamps at its ceiling and a box on its floor, around the axis of a camera at the origin.
class LitRoom {
  public:
    LitRoom(client::Session& session, scene::BlobStore& blobs);

    // Of the room, which becomes the only child of the root.
    const std::vector<scene::Entry>& entries() const { return entries_; }
    ObjectId place() const { return place_; }
    scene::Update shine(std::size_t lamp, float emission) const;

  private:
    ObjectId material(scene::Material material);
    void quad(ObjectId material, const std::array<glm::vec3, 4>& corners);

    client::Session& session_;
    scene::BlobStore& blobs_;
    ObjectId place_;
    std::array<ObjectId, 2> lamps_;
    std::vector<ObjectId> parts_;
    std::vector<scene::Entry> entries_;
};

}  // namespace tessera::test
