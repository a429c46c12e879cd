#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <vector>

#include "mediator/scene/scene.h"
#include "mediator/view/view.h"

namespace tessera::test {

enum class Normals { Flat, Smooth };
enum class Tangents { Given, None };

// A scene put together in a test: spheres, quads, lights, a sky.
class SceneModel {
  public:
    explicit SceneModel(glm::dvec3 render_origin = glm::dvec3(0.0)) { root_.render_origin = render_origin; }

    ObjectId material(const scene::Material& material) { return create(material); }
    ObjectId shader(const scene::SurfaceShader& shader) { return create(shader); }
    // The interior medium of boxes and spheres added from now on.
    void set_medium(const scene::Medium& medium) { medium_ = create(medium); }
    void clear_medium() { medium_ = ObjectId{}; }

    void sphere(ObjectId material, const glm::dvec3& center, double radius, Normals normals = Normals::Flat,
                unsigned rings = 24) {
        const unsigned sectors = 2 * rings;
        std::vector<glm::vec3> positions;
        std::vector<std::uint32_t> indices;
        for (unsigned ring = 0; ring <= rings; ++ring) {
            for (unsigned sector = 0; sector <= sectors; ++sector) {
                // Vertices are shared at the seam, so that the mesh is closed.
                const double theta = M_PI * ring / rings, phi = 2.0 * M_PI * (sector % sectors) / sectors;
                const double sine = ring % rings == 0 ? 0.0 : std::sin(theta);
                positions.emplace_back(sine * std::cos(phi), std::cos(theta), sine * std::sin(phi));
            }
        }
        for (unsigned ring = 0; ring < rings; ++ring) {
            for (unsigned sector = 0; sector < sectors; ++sector) {
                const std::uint32_t a = ring * (sectors + 1) + sector, b = a + sectors + 1;
                if (ring > 0) indices.insert(indices.end(), {a, a + 1, b});
                if (ring + 1 < rings) indices.insert(indices.end(), {a + 1, b + 1, b});
            }
        }
        scene::Geometry geometry{
            .material = material, .indices = blob(indices), .positions = blob(positions), .medium = medium_};
        if (normals == Normals::Smooth) geometry.normals = geometry.positions;
        hang(create(geometry), glm::scale(glm::translate(glm::dmat4(1.0), center), glm::dvec3(radius)));
    }

    // Closed, with its front outside. No material: without a surface, if it is filled.
    void box(ObjectId material, const glm::vec3& low, const glm::vec3& high) {
        std::vector<glm::vec3> positions;
        for (int i = 0; i < 8; ++i) {
            positions.emplace_back((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                                   (i & 4) != 0 ? high.z : low.z);
        }
        const std::vector<std::uint32_t> indices{0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                                 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
        hang(create(scene::Geometry{.material = material,
                                    .indices = blob(indices),
                                    .positions = blob(positions),
                                    .medium = medium_}),
             glm::dmat4(1.0));
    }

    // Corners counter-clockwise as seen from the front; colours, if any, per corner.
    void quad(ObjectId material, const std::array<glm::vec3, 4>& corners,
              const std::vector<glm::vec4>& colors = {}) {
        const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
        scene::Geometry geometry{.material = material,
                                 .indices = blob(indices),
                                 .positions = blob(std::vector<glm::vec3>(corners.begin(), corners.end()))};
        if (!colors.empty()) geometry.colors = blob(colors);
        hang(create(geometry), glm::dmat4(1.0));
    }
    // Each by its corners, counter-clockwise as seen from the front.
    void triangles(ObjectId material, const std::vector<std::array<glm::vec3, 3>>& triangles,
                   std::uint32_t layers = scene::RootLayers) {
        if (triangles.empty()) return;
        std::vector<glm::vec3> positions;
        std::vector<std::uint32_t> indices;
        for (const std::array<glm::vec3, 3>& corners : triangles) {
            for (const glm::vec3& corner : corners) {
                indices.push_back(static_cast<std::uint32_t>(positions.size()));
                positions.push_back(corner);
            }
        }
        const scene::Geometry geometry{
            .material = material, .indices = blob(indices), .positions = blob(positions)};
        hang(create(geometry), glm::dmat4(1.0), layers);
    }
    // A quad with a texture, `repeats` times along the edges, and tangents along the first one, if any. The
    // second set of coordinates has u along the second edge.
    void textured_quad(ObjectId material, const std::array<glm::vec3, 4>& corners, float repeats,
                       Tangents given = Tangents::Given) {
        const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
        const std::vector<glm::vec2> tex_coords{{0, 0}, {repeats, 0}, {repeats, repeats}, {0, repeats}};
        const std::vector<glm::vec4> tangents(4, glm::vec4(glm::normalize(corners[1] - corners[0]), -1.0f));
        const scene::Geometry geometry{
            .material = material,
            .indices = blob(indices),
            .positions = blob(std::vector<glm::vec3>(corners.begin(), corners.end())),
            .tangents = given == Tangents::Given ? blob(tangents) : scene::BlobRef{},
            .tex_coords = blob(tex_coords),
            .tex_coords_1 = blob(std::vector<glm::vec2>{{0, 1}, {0, 0}, {1, 0}, {1, 1}})};
        hang(create(geometry), glm::dmat4(1.0));
    }
    // A square of half edge `size` at height z, its front to +z (or to -z, size negative).
    void floor(ObjectId material, float size, float z, const std::vector<glm::vec4>& colors = {}) {
        const float s = std::fabs(size);
        quad(material, {{{-size, -s, z}, {size, -s, z}, {size, s, z}, {-size, s, z}}}, colors);
    }

    // Texels row by row, bytes or floats as the texture's format says.
    template <class T>
    scene::TextureSlot texture(scene::Texture described, const std::vector<T>& texels) {
        described.texels = blob(texels);
        return {.texture = create(described)};
    }

    void sky(const glm::vec3& color) { sky(scene::Background{.color = color}); }
    void sky(const scene::Background& background) { root_.background = create(background); }
    void point_light(const glm::dvec3& place, float intensity) {
        light({.kind = scene::LightKind::Point, .intensity = glm::vec3(intensity)},
              glm::translate(glm::dmat4(1.0), place));
    }
    void light(const scene::Light& source, const glm::dmat4& place,
               std::uint32_t layers = scene::RootLayers) {
        hang(create(source), place, layers);
    }

    // The motion of everything added from now on while the shutter is open: transforms at even motion keys after the
    // first, each seen from the first.
    void moves(const std::vector<glm::dmat4>& steps) { steps_ = steps; }
    // As quad, but its corners move.
    void deforming_quad(ObjectId material, const std::vector<std::array<glm::vec3, 4>>& corners) {
        const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
        scene::Geometry geometry{.material = material, .indices = blob(indices)};
        for (const std::array<glm::vec3, 4>& step : corners) {
            const scene::BlobRef positions = blob(std::vector<glm::vec3>(step.begin(), step.end()));
            if (geometry.positions.empty()) {
                geometry.positions = positions;
            } else {
                geometry.motion_positions.push_back(positions);
            }
        }
        hang(create(geometry), glm::dmat4(1.0));
    }

    // Origin and scale of everything added from now on.
    void placed_at(const glm::dvec3& origin) { frame_ = glm::translate(glm::dmat4(1.0), origin); }
    void set_frame(const glm::dmat4& frame) { frame_ = frame; }
    void scaled_by(double size) { frame_ = glm::scale(glm::dmat4(1.0), glm::dvec3(size)); }

    // Once.
    scene::Scene finished() {
        entries_.push_back(scene::Create{scene::RootId, root_});
        scene::Scene scene;
        EXPECT_TRUE(scene.apply_entries(entries_));
        scene.set_version({1, 1});
        return scene;
    }
    const std::shared_ptr<scene::BlobStore>& blobs() const { return blobs_; }

  private:
    template <class T>
    scene::BlobRef blob(const std::vector<T>& values) {
        return scene::reference(*blobs_->insert(std::as_bytes(std::span(values))));
    }
    template <class T>
    ObjectId create(const T& object) {
        const ObjectId id{next_++};
        entries_.push_back(scene::Create{id, object});
        return id;
    }
    void hang(ObjectId child, const glm::dmat4& place, std::uint32_t layers = scene::RootLayers) {
        scene::Transform transform{.matrix = frame_ * place, .children = {child}, .layers = layers};
        for (const glm::dmat4& step : steps_) transform.motion.push_back(step * transform.matrix);
        root_.children.push_back(create(transform));
    }

    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    scene::Root root_;
    glm::dmat4 frame_{1.0};
    ObjectId medium_;
    std::vector<glm::dmat4> steps_;
    std::vector<scene::Entry> entries_;
    std::uint64_t next_ = 2;
};

// A square picture from `eye` along -z of `turn`.
inline view::View small_view(const glm::dvec3& eye, double vertical_fov, std::uint32_t size = 16,
                             const glm::dmat4& turn = glm::dmat4(1.0)) {
    view::View view;
    view.width = view.height = size;
    view.window = {0, 0, static_cast<std::int32_t>(size), static_cast<std::int32_t>(size)};
    view.seed = 11;
    view.max_bounces = view.max_specular_bounces = view::UnlimitedBounces;
    view.camera = view::perspective(glm::translate(glm::dmat4(1.0), eye) * turn, vertical_fov, 1.0);
    return view;
}

inline scene::Material glass(float index, const glm::vec3& color = glm::vec3(1.0f)) {
    return {.base_color = glm::vec4(color, 1.0f),
            .roughness = 0.0f,
            .double_sided = true,
            .index_of_refraction = index,
            .transmission = 1.0f,
            .thickness = 1.0f};
}
inline scene::Material mirror(const glm::vec3& color) {
    return {.base_color = glm::vec4(color, 1.0f), .metallic = 1.0f, .roughness = 0.0f};
}
// No coat: nothing but the diffuse lobe.
inline scene::Material chalk(const glm::vec3& color) {
    return {.base_color = glm::vec4(color, 1.0f), .double_sided = true, .index_of_refraction = 1.0f};
}
inline scene::Material lamp(float radiance) {
    return {.base_color = {0.0f, 0.0f, 0.0f, 1.0f},
            .emission = glm::vec3(radiance),
            .double_sided = true,
            .index_of_refraction = 1.0f};
}

}  // namespace tessera::test
