#include "client/import/x3d_primitives.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <string_view>

#include "client/import/x3d_fields.h"

namespace tessera::import {
namespace {

constexpr std::uint32_t Sides = 72, Rings = 36;

std::uint32_t add_vertex(MeshData& mesh, const glm::dvec3& position, const glm::dvec3& normal,
                         const glm::dvec2& tex_coord) {
    mesh.positions.emplace_back(position);
    mesh.normals.emplace_back(normal);
    mesh.tex_coords.emplace_back(tex_coord);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

void add_quad(MeshData& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
}

// Around y from the back (-z), counter-clockwise seen from above: the direction of X3D's texture coordinates.
glm::dvec3 around(double s) {
    return {-std::sin(2.0 * std::numbers::pi * s), 0.0, -std::cos(2.0 * std::numbers::pi * s)};
}

MeshData box(const glm::dvec3& size) {
    struct Side {
        glm::dvec3 right, up;  // seen from outside
    };
    constexpr glm::dvec3 X{1, 0, 0}, Y{0, 1, 0}, Z{0, 0, 1};
    MeshData mesh;
    for (const auto& [right, up] : {Side{X, Y}, {-X, Y}, {-Z, Y}, {Z, Y}, {X, -Z}, {X, Z}}) {
        const glm::dvec3 normal = glm::cross(right, up);
        const auto corner = [&](double s, double t) {
            const glm::dvec3 point = normal + (2.0 * s - 1.0) * right + (2.0 * t - 1.0) * up;
            return add_vertex(mesh, 0.5 * size * point, normal, {s, t});
        };
        const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
        add_quad(mesh, a, b, c, d);
    }
    return mesh;
}

MeshData sphere(double radius) {
    MeshData mesh;
    for (std::uint32_t ring = 0; ring <= Rings; ++ring) {
        const double t = static_cast<double>(ring) / Rings;
        for (std::uint32_t side = 0; side <= Sides; ++side) {
            const double s = static_cast<double>(side) / Sides;
            // Makes poles and seam exact.
            const double sine = ring == 0 || ring == Rings ? 0.0 : std::sin(std::numbers::pi * t);
            const glm::dvec3 normal = sine * around(side == Sides ? 0.0 : s) +
                                      glm::dvec3(0.0, -std::cos(std::numbers::pi * t), 0.0);
            add_vertex(mesh, radius * normal, normal, {s, t});
        }
    }
    for (std::uint32_t ring = 0; ring < Rings; ++ring) {
        for (std::uint32_t side = 0; side < Sides; ++side) {
            const std::uint32_t low = ring * (Sides + 1) + side, high = low + Sides + 1;
            if (ring > 0) mesh.indices.insert(mesh.indices.end(), {low, low + 1, high + 1});
            if (ring + 1 < Rings) mesh.indices.insert(mesh.indices.end(), {low, high + 1, high});
        }
    }
    // One vertex at each pole is unused.
    return mesh;
}

// A truncated cone from y = -h/2 to y = h/2.
void add_wall(MeshData& mesh, double bottom_radius, double top_radius, double height) {
    const double slope = bottom_radius - top_radius;
    for (std::uint32_t side = 0; side < Sides; ++side) {
        const double s0 = static_cast<double>(side) / Sides, s1 = static_cast<double>(side + 1) / Sides;
        const auto vertex = [&](double s, double s_of_normal, double t) {
            const double radius = t > 0.0 ? top_radius : bottom_radius;
            const glm::dvec3 normal = glm::normalize(height * around(s_of_normal) + glm::dvec3(0, slope, 0));
            return add_vertex(mesh, radius * around(s) + glm::dvec3(0.0, (t - 0.5) * height, 0.0), normal,
                              {s, t});
        };
        const double end = side + 1 == Sides ? 0.0 : s1;
        const std::uint32_t a = vertex(s0, s0, 0.0), b = vertex(s1, end, 0.0);
        if (top_radius > 0.0) {
            const std::uint32_t c = vertex(s1, end, 1.0), d = vertex(s0, s0, 1.0);
            add_quad(mesh, a, b, c, d);
        } else {
            // The tip has one normal per triangle.
            mesh.indices.insert(mesh.indices.end(), {a, b, vertex(0.5 * (s0 + s1), 0.5 * (s0 + s1), 1.0)});
        }
    }
}

// A disc at `y` that faces up (1) or down (-1); its texture is a circle cut out of the image.
void add_disc(MeshData& mesh, double radius, double y, double facing) {
    std::vector<std::uint32_t> rim;
    for (std::uint32_t side = 0; side < Sides; ++side) {
        const glm::dvec3 point = around(static_cast<double>(side) / Sides);
        rim.push_back(add_vertex(mesh, radius * point + glm::dvec3(0.0, y, 0.0), {0.0, facing, 0.0},
                                 {0.5 + 0.5 * point.x, 0.5 - 0.5 * facing * point.z}));
    }
    for (std::uint32_t side = 1; side + 1 < Sides; ++side) {
        const std::uint32_t next = facing > 0.0 ? side + 1 : side, other = facing > 0.0 ? side : side + 1;
        mesh.indices.insert(mesh.indices.end(), {rim[0], rim[other], rim[next]});
    }
}

MeshData cylinder(const X3dFields& fields) {
    const double radius = fields.number("radius", 1.0, Positive),
                 height = fields.number("height", 2.0, Positive);
    MeshData mesh;
    if (fields.flag("side", true)) add_wall(mesh, radius, radius, height);
    if (fields.flag("top", true)) add_disc(mesh, radius, 0.5 * height, 1.0);
    if (fields.flag("bottom", true)) add_disc(mesh, radius, -0.5 * height, -1.0);
    return mesh;
}

MeshData cone(const X3dFields& fields) {
    const double radius = fields.number("bottomRadius", 1.0, Positive),
                 height = fields.number("height", 2.0, Positive);
    MeshData mesh;
    if (fields.flag("side", true)) add_wall(mesh, radius, 0.0, height);
    if (fields.flag("bottom", true)) add_disc(mesh, radius, -0.5 * height, -1.0);
    return mesh;
}

}  // namespace

std::optional<MeshData> read_primitive(X3dDocument& document, pugi::xml_node node) {
    const X3dFields fields(node, document.diagnostics());
    const std::string_view kind = node.name();
    if (kind == "Box") return box(fields.vector("size", glm::dvec3(2.0), Positive));
    if (kind == "Sphere") return sphere(fields.number("radius", 1.0, Positive));
    if (kind == "Cylinder") return cylinder(fields);
    if (kind == "Cone") return cone(fields);
    return std::nullopt;
}

}  // namespace tessera::import
