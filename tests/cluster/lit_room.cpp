#include "tests/cluster/lit_room.h"

#include <span>

#include "mediator/scene/fields.h"

namespace tessera::test {

using namespace scene;

LitRoom::LitRoom(client::Session& session, BlobStore& blobs)
    : session_(session), blobs_(blobs), place_(session.new_id()) {
    const ObjectId white = material({}), red = material({.base_color = {0.7f, 0.1f, 0.1f, 1.0f}});
    for (ObjectId& lamp : lamps_) lamp = material({.emission = glm::vec3(20.0f)});
    const auto wall = [&](ObjectId of, glm::vec3 corner, glm::vec3 right, glm::vec3 up) {
        quad(of, {corner, corner + right, corner + right + up, corner + up});
    };
    wall(white, {-1.5f, -1, -1}, {3, 0, 0}, {0, 0, -3});          // floor
    wall(white, {-1.5f, 1, -4}, {3, 0, 0}, {0, 0, 3});            // ceiling
    wall(red, {-1.5f, -1, -1}, {0, 0, -3}, {0, 2, 0});            // left
    wall(white, {1.5f, -1, -4}, {0, 0, 3}, {0, 2, 0});            // right
    wall(white, {-1.5f, -1, -4}, {3, 0, 0}, {0, 2, 0});           // back
    wall(white, {-0.3f, -1, -2.2f}, {0.6f, 0, 0}, {0, 0.7f, 0});  // the box's front
    wall(white, {-0.3f, -0.3f, -2.2f}, {0.6f, 0, 0}, {0, 0, -0.6f});
    wall(lamps_[0], {-1.0f, 0.95f, -2.7f}, {0.4f, 0, 0}, {0, 0, 0.4f});
    wall(lamps_[1], {0.6f, 0.95f, -2.7f}, {0.4f, 0, 0}, {0, 0, 0.4f});
    entries_.emplace_back(Create{place_, Transform{.children = parts_}});
    entries_.emplace_back(Update{RootId, Fields<Root>(&Root::children).bits(), Root{.children = {place_}}});
}

Update LitRoom::shine(std::size_t lamp, float emission) const {
    return {lamps_[lamp], Fields<Material>(&Material::emission).bits(),
            Material{.emission = glm::vec3(emission)}};
}

ObjectId LitRoom::material(Material material) {
    material.double_sided = true;
    const ObjectId id = session_.new_id();
    entries_.emplace_back(Create{id, std::move(material)});
    return id;
}

void LitRoom::quad(ObjectId material, const std::array<glm::vec3, 4>& corners) {
    constexpr std::array<std::uint32_t, 6> Indices{0, 1, 2, 0, 2, 3};
    parts_.push_back(session_.new_id());
    entries_.emplace_back(Create{
        parts_.back(), Geometry{.material = material,
                                .indices = reference(*blobs_.insert(std::as_bytes(std::span(Indices)))),
                                .positions = reference(*blobs_.insert(std::as_bytes(std::span(corners))))}});
}

}  // namespace tessera::test
