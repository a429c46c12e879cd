#pragma once

#include <gtest/gtest.h>

#include <array>
#include <glm/gtc/matrix_transform.hpp>

#include "backends/embree/scene_adapter.h"

namespace tessera::embree {

// A closed box whose walls emit 1 and reflect the share `albedo`, diffusely; as large and as far away as one
// likes, with the render origin near it.
struct Furnace {
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    DeviceHandle device = make_device({.threads = 1, .blobs = blobs});
    SceneAdapter world{device.get(), blobs};

    explicit Furnace(float albedo, double scale = 1.0, glm::dvec3 place = glm::dvec3(0.0)) {
        std::array<glm::vec3, 8> corners;
        for (unsigned i = 0; i < 8; ++i) {
            corners[i] = {(i & 1u) ? 1.0f : -1.0f, (i & 2u) ? 1.0f : -1.0f, (i & 4u) ? 1.0f : -1.0f};
        }
        constexpr std::array<std::uint32_t, 36> Triangles{0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6,
                                                          0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7,
                                                          0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
        const scene::BlobPtr positions = blobs->insert(std::as_bytes(std::span(corners)));
        const scene::BlobPtr indices = blobs->insert(std::as_bytes(std::span(Triangles)));
        const scene::Root root{.children = {ObjectId{4}}, .render_origin = glm::round(place / 256.0) * 256.0};
        const scene::Transform transform{
            .matrix = glm::scale(glm::translate(glm::dmat4(1.0), place), glm::dvec3(scale)),
            .children = {ObjectId{2}}};
        const scene::Geometry box{.material = ObjectId{3},
                                  .indices = scene::reference(*indices),
                                  .positions = scene::reference(*positions)};
        // Index of refraction 1: no interface, so nothing but the diffuse lobe.
        const scene::Material walls{.base_color = {albedo, albedo, albedo, 1.0f},
                                    .emission = glm::vec3(1.0f),
                                    .double_sided = true,
                                    .index_of_refraction = 1.0f};
        scene::Scene built;
        EXPECT_TRUE(
            built.apply_entries({scene::Create{scene::RootId, root}, scene::Create{ObjectId{2}, box},
                                 scene::Create{ObjectId{4}, transform}, scene::Create{ObjectId{3}, walls}}));
        built.set_version({1, 1});
        EXPECT_TRUE(world.apply(scene::snapshot(built)));
        EXPECT_TRUE(world.commit());
    }
};

}  // namespace tessera::embree
