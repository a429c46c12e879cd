#include "tests/cluster/cluster_scene.h"

#include <array>

#include "mediator/scene/fields.h"

namespace tessera::test {

using namespace scene;

std::vector<Entry> scene_entries(ObjectId first, BlobStore& blobs) {
    constexpr std::array<glm::vec3, 3> Corners{glm::vec3(-1, -1, -3), glm::vec3(1, -1, -3),
                                               glm::vec3(0, 1, -3)};
    constexpr std::array<std::uint32_t, 3> Triangle{0, 1, 2};
    const BlobPtr positions = blobs.insert(std::as_bytes(std::span(Corners)));
    const BlobPtr indices = blobs.insert(std::as_bytes(std::span(Triangle)));
    const ObjectId material{first.value + 1}, a{first.value + 2}, b{first.value + 3};
    Geometry geometry{
        .material = material, .indices = reference(*indices), .positions = reference(*positions)};
    Transform transform{.children = {a, b}};
    const Root root{.children = {first}};
    return {Create{first, transform}, Create{material, Material{.emission = glm::vec3(1.0f)}},
            Create{a, geometry}, Create{b, geometry},
            Update{RootId, Fields<Root>(&Root::children).bits(), root}};
}

}  // namespace tessera::test
