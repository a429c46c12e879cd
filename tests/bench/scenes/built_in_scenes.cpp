#include "tests/bench/scenes/built_in_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>

#include "mediator/base/random.h"
#include "tests/bench/scenes/shapes.h"

namespace tessera::tools::bench {

namespace {

class Builder {
  public:
    ObjectId material(scene::Material value) {
        value.double_sided = true;
        return add(std::move(value));
    }
    ObjectId diffuse(glm::vec3 color) {
        // Index of refraction 1: no interface, so nothing but the diffuse lobe.
        return material({.base_color = glm::vec4(color, 1.0f), .index_of_refraction = 1.0f});
    }
    ObjectId light(float radiance) {
        return material({.base_color = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f),
                         .emission = glm::vec3(radiance),
                         .index_of_refraction = 1.0f});
    }
    ObjectId mirror() {
        return material({.base_color = glm::vec4(0.95f), .metallic = 1.0f, .roughness = 0.0f});
    }
    ObjectId glass() {
        return material({.base_color = glm::vec4(1.0f),
                         .roughness = 0.0f,
                         .index_of_refraction = 1.5f,
                         .transmission = 1.0f,
                         .thickness = 1.0f});
    }

    void add_mesh(const std::string& name, const Mesh& mesh, ObjectId material) {
        scene::Geometry geometry{.name = name, .material = material};
        geometry.positions = blob(mesh.positions);
        if (!mesh.normals.empty()) geometry.normals = blob(mesh.normals);
        geometry.indices = blob(mesh.indices);
        root_.children.push_back(add(std::move(geometry)));
    }

    BenchScene finish(BenchScene scene, glm::dvec3 eye, glm::dvec3 target, double vertical_fov,
                      float background = 0.0f) {
        const glm::dvec3 z = glm::normalize(eye - target);
        const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), z));
        scene.camera = {.name = "camera",
                        .world_from_camera = {glm::dvec4(x, 0.0), glm::dvec4(glm::cross(z, x), 0.0),
                                              glm::dvec4(z, 0.0), glm::dvec4(eye, 1.0)},
                        .camera = {.vertical_fov = vertical_fov}};
        root_.background =
            add(background > 0.0f ? scene::Background{.name = "furnace", .color = glm::vec3(background)}
                                  : scene::Background{.name = "dark"});
        entries_.push_back(scene::Create{scene::RootId, root_});
        if (auto applied = scene.content.apply_entries(entries_); !applied) throw applied.error();
        scene.content.set_version({1, 1});
        scene.blobs = std::move(blobs_);
        return scene;
    }

  private:
    ObjectId add(scene::Object object) {
        const ObjectId id{next_id_++};
        entries_.push_back(scene::Create{id, std::move(object)});
        return id;
    }
    template <class T>
    scene::BlobRef blob(const std::vector<T>& values) {
        blobs_.push_back(std::make_shared<scene::Blob>(std::as_bytes(std::span(values))));
        return scene::reference(*blobs_.back());
    }

    std::uint64_t next_id_ = 2;
    scene::Root root_{.name = "root"};
    std::vector<scene::Entry> entries_;
    std::vector<scene::BlobPtr> blobs_;
};

// From (-1, 0, -1) to (1, 2, 1), open towards +z, where the camera is.
void add_cornell_walls(Builder& builder) {
    const ObjectId white = builder.diffuse({0.73f, 0.73f, 0.73f});
    Mesh walls = quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1});
    append(walls, quad({-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}));
    append(walls, quad({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}));
    builder.add_mesh("floor, ceiling and back", walls, white);
    builder.add_mesh("left", quad({-1, 0, 1}, {-1, 0, -1}, {-1, 2, -1}, {-1, 2, 1}),
                     builder.diffuse({0.65f, 0.05f, 0.05f}));
    builder.add_mesh("right", quad({1, 0, -1}, {1, 0, 1}, {1, 2, 1}, {1, 2, -1}),
                     builder.diffuse({0.12f, 0.45f, 0.15f}));
    constexpr float Edge = 0.25f, Height = 1.99f;
    builder.add_mesh(
        "light",
        quad({-Edge, Height, -Edge}, {Edge, Height, -Edge}, {Edge, Height, Edge}, {-Edge, Height, Edge}),
        builder.light(15.0f));
}

BenchScene cornell() {
    Builder builder;
    add_cornell_walls(builder);
    Mesh blocks = block({-0.33f, 0.0f, -0.30f}, {0.6f, 1.2f, 0.6f}, 0.3f);
    append(blocks, block({0.36f, 0.0f, 0.35f}, {0.6f, 0.6f, 0.6f}, -0.3f));
    builder.add_mesh("blocks", blocks, builder.diffuse({0.73f, 0.73f, 0.73f}));
    return builder.finish({.name = "cornell", .kind = "diffuse surfaces", .summary = "Cornell box"},
                          {0.0, 1.0, 3.9}, {0.0, 1.0, 0.0}, 0.66);
}

BenchScene cornell_spheres() {
    Builder builder;
    add_cornell_walls(builder);
    builder.add_mesh("mirror", sphere({-0.42f, 0.45f, -0.30f}, 0.45f, 48), builder.mirror());
    builder.add_mesh("glass", sphere({0.45f, 0.40f, 0.30f}, 0.40f, 48), builder.glass());
    return builder.finish({.name = "cornell-spheres",
                           .kind = "mirror and glass",
                           .summary = "Cornell box with a mirror and a glass sphere"},
                          {0.0, 1.0, 3.9}, {0.0, 1.0, 0.0}, 0.66);
}

BenchScene caustics() {
    Builder builder;
    builder.add_mesh("plane", quad({-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}),
                     builder.diffuse({0.6f, 0.58f, 0.55f}));
    builder.add_mesh("ball", sphere({0.0f, 0.6f, 0.0f}, 0.6f, 64), builder.glass());
    constexpr float Edge = 0.35f;
    const glm::vec3 at(0.9f, 2.6f, -0.9f);
    builder.add_mesh("light",
                     quad(at + glm::vec3(-Edge, 0, -Edge), at + glm::vec3(Edge, 0, -Edge),
                          at + glm::vec3(Edge, 0, Edge), at + glm::vec3(-Edge, 0, Edge)),
                     builder.light(20.0f));
    return builder.finish(
        {.name = "caustics", .kind = "caustics", .summary = "glass sphere on a plane under a small light"},
        {0.0, 1.9, 3.6}, {-0.1, 0.35, 0.0}, 0.66);
}

BenchScene grids() {
    Builder builder;
    builder.add_mesh("plane", quad({-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}),
                     builder.diffuse({0.7f, 0.7f, 0.7f}));
    Mesh layers = grid(0.4f, 2.4f, 8, 0.08f);
    append(layers, grid(1.5f, 2.0f, 5, 0.12f));
    builder.add_mesh("grids", layers, builder.diffuse({0.5f, 0.25f, 0.12f}));
    constexpr float Sigma = 0.5f, Height = 4.0f;
    builder.add_mesh("light",
                     quad({-Sigma, Height, -Sigma}, {Sigma, Height, -Sigma}, {Sigma, Height, Sigma},
                          {-Sigma, Height, Sigma}),
                     builder.light(12.0f));
    return builder.finish({.name = "grids",
                           .kind = "soft shadows",
                           .summary = "two layers of bars under a square light, direct light only",
                           .max_bounces = 0},
                          {2.6, 3.1, 3.4}, {0.0, 0.35, 0.0}, 0.66);
}

BenchScene furnace() {
    Builder builder;
    for (int i = 0; i < 4; ++i) {
        const float x = -1.65f + 1.1f * float(i);
        builder.add_mesh("plastic " + std::to_string(i + 1), sphere({x, 0.55f, 0.0f}, 0.5f, 48),
                         builder.material({.base_color = glm::vec4(0.8f, 0.8f, 0.8f, 1.0f),
                                           .roughness = 0.1f + 0.3f * float(i)}));
        builder.add_mesh("metal " + std::to_string(i + 1), sphere({x, -0.55f, 0.0f}, 0.5f, 48),
                         builder.material({.base_color = glm::vec4(0.9f, 0.9f, 0.9f, 1.0f),
                                           .metallic = 1.0f,
                                           .roughness = 0.1f + 0.3f * float(i)}));
    }
    return builder.finish({.name = "furnace",
                           .kind = "uniform light",
                           .summary = "plastic and metal of four roughnesses under an even sky"},
                          {0.0, 0.0, 6.0}, {0.0, 0.0, 0.0}, 0.5, 1.0f);
}

// After Veach: plates of growing roughness that mirror lights of growing size and equal power.
BenchScene glossy() {
    Builder builder;
    builder.add_mesh("floor and wall", quad({-4, 0, 4}, {4, 0, 4}, {4, 0, -2}, {-4, 0, -2}),
                     builder.diffuse({0.4f, 0.4f, 0.4f}));
    builder.add_mesh("wall", quad({-4, 0, -2}, {4, 0, -2}, {4, 5, -2}, {-4, 5, -2}),
                     builder.diffuse({0.4f, 0.4f, 0.4f}));
    const glm::vec3 eye(0.0f, 2.0f, 7.0f), lights(0.0f, 3.2f, -1.0f);
    for (int i = 0; i < 4; ++i) {
        const glm::vec3 centre(0.0f, 0.25f + 0.35f * float(3 - i), 1.6f - 0.7f * float(3 - i));
        const glm::vec3 normal =
            glm::normalize(glm::normalize(eye - centre) + glm::normalize(lights - centre));
        const glm::vec3 across(1.8f, 0.0f, 0.0f),
            along = 0.28f * glm::cross(normal, glm::vec3(1.0f, 0.0f, 0.0f));
        builder.add_mesh(
            "plate " + std::to_string(i + 1),
            quad(centre - across - along, centre - across + along, centre + across + along,
                 centre + across - along),
            builder.material({.base_color = glm::vec4(0.8f, 0.8f, 0.8f, 1.0f),
                              .metallic = 1.0f,
                              .roughness = std::array{0.1f, 0.2f, 0.35f, 0.5f}[std::size_t(i)]}));
    }
    for (int i = 0; i < 3; ++i) {
        const float radius = std::array{0.04f, 0.13f, 0.4f}[std::size_t(i)];
        builder.add_mesh("lamp " + std::to_string(i + 1),
                         sphere(lights + glm::vec3(1.2f * float(i - 1), 0.0f, 0.0f), radius, 24),
                         builder.light(1.0f / (radius * radius)));
    }
    return builder.finish({.name = "glossy",
                           .kind = "glossy surfaces",
                           .summary = "metal plates that mirror lamps of three sizes"},
                          {eye.x, eye.y, eye.z}, {0.0, 1.4, 0.0}, 0.5);
}

}  // namespace

BenchScene balls(std::uint32_t triangles) {
    constexpr std::uint32_t Count = 50;
    // A sphere of r rings has 4 r (r - 1) triangles.
    const auto rings = static_cast<std::uint32_t>(std::sqrt(std::max(triangles, 1000u) / Count / 4.0) + 1.0);
    Builder builder;
    add_cornell_walls(builder);
    CounterRandom random(7);
    const auto between = [&](float low, float high) {
        return low + (high - low) * static_cast<float>(random.uniform());
    };
    Mesh all;
    for (std::uint32_t i = 0; i < Count; ++i) {
        const float radius = between(0.05f, 0.2f), x = between(-0.8f, 0.8f);
        const float y = between(0.2f, 1.7f), z = between(-0.8f, 0.8f);
        append(all, sphere({x, y, z}, radius, rings));
    }
    builder.add_mesh("balls", all, builder.diffuse({0.6f, 0.6f, 0.65f}));
    return builder.finish({.name = "balls:" + std::to_string(triangles),
                           .kind = "many triangles",
                           .summary = std::to_string(all.indices.size() / 3) + " triangles in a box"},
                          {0.0, 1.0, 3.9}, {0.0, 1.0, 0.0}, 0.66);
}

const std::vector<BuiltIn>& built_in_scenes() {
    static const std::vector<BuiltIn> scenes{
        {"cornell", cornell}, {"cornell-spheres", cornell_spheres}, {"caustics", caustics},
        {"grids", grids},     {"furnace", furnace, false},          {"glossy", glossy, false}};
    return scenes;
}

}  // namespace tessera::tools::bench
