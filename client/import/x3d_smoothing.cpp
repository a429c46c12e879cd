#include "client/import/x3d_smoothing.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera::import {
namespace {

constexpr std::size_t MostFacesCompared =
    1000;  // the comparison is quadratic: bounds the time for malformed files

glm::dvec3 unit_or_zero(const glm::dvec3& vector) {
    const double length = glm::length(vector);
    return length > 0.0 && std::isfinite(length) ? vector / length : glm::dvec3(0.0);
}

class Smoothing {
  public:
    explicit Smoothing(FaceSet& faces) : faces_(faces), at_point_(faces.positions.size()) {
        for (std::size_t face = 0; face < faces_.ends.size(); ++face) add_face(face);
    }

    void run() {
        faces_.normals.clear();
        const bool all = faces_.crease_angle >= std::numbers::pi;
        const double least_cosine = std::cos(std::min(faces_.crease_angle, std::numbers::pi));
        for (std::size_t point = 0; point < at_point_.size(); ++point) {
            const std::vector<std::size_t>& corners = at_point_[point];
            const std::size_t first_normal = faces_.normals.size();
            if (all || corners.size() > MostFacesCompared) {
                const std::uint32_t normal = normal_index(sum(corners, glm::dvec3(0.0), -2.0), first_normal);
                for (const std::size_t corner : corners) faces_.corners[corner].normal = normal;
                continue;
            }
            for (const std::size_t corner : corners) {
                faces_.corners[corner].normal =
                    normal_index(sum(corners, normals_[face_of_[corner]], least_cosine), first_normal);
            }
        }
    }

  private:
    void add_face(std::size_t face) {
        const std::size_t first = face == 0 ? 0 : faces_.ends[face - 1], end = faces_.ends[face];
        std::vector<glm::vec3> outline;
        for (std::size_t i = first; i < end; ++i) outline.push_back(point(i));
        const double side = faces_.counter_clockwise ? 1.0 : -1.0;
        normals_.push_back(side * unit_or_zero(polygon_area(outline)));
        for (std::size_t i = first; i < end; ++i) {
            const glm::dvec3 before = glm::dvec3(point(i == first ? end - 1 : i - 1)) - glm::dvec3(point(i));
            const glm::dvec3 after = glm::dvec3(point(i + 1 == end ? first : i + 1)) - glm::dvec3(point(i));
            const double sine = glm::length(glm::cross(before, after));
            angles_.push_back(std::atan2(sine, glm::dot(before, after)));
            face_of_.push_back(face);
            at_point_[faces_.corners[i].position].push_back(i);
        }
    }

    glm::vec3 point(std::size_t corner) const { return faces_.positions[faces_.corners[corner].position]; }

    // Weighted sum over the faces whose normals are within that cosine of `normal`. Degenerate faces have no
    // normal.
    glm::dvec3 sum(const std::vector<std::size_t>& corners, const glm::dvec3& normal, double cosine) const {
        glm::dvec3 total(0.0);
        for (const std::size_t corner : corners) {
            const glm::dvec3& other = normals_[face_of_[corner]];
            if (other == normal || glm::dot(other, normal) > cosine) total += angles_[corner] * other;
        }
        return total;
    }

    // Index of the normal; equal normals of one point are shared. A sum of zero is repaired by
    // check_and_repair.
    std::uint32_t normal_index(const glm::dvec3& total, std::size_t first_of_point) {
        const glm::vec3 normal(unit_or_zero(total));
        const auto begin = faces_.normals.begin() + static_cast<std::ptrdiff_t>(first_of_point);
        const auto found = std::find(begin, faces_.normals.end(), normal);
        const auto index = static_cast<std::uint32_t>(found - faces_.normals.begin());
        if (found == faces_.normals.end()) faces_.normals.push_back(normal);
        return index;
    }

    FaceSet& faces_;
    std::vector<std::vector<std::size_t>> at_point_;  // corners
    std::vector<glm::dvec3> normals_;                 // of faces
    std::vector<double> angles_;                      // of corners
    std::vector<std::size_t> face_of_;                // of corners
};

}  // namespace

void add_smooth_normals(FaceSet& faces) {
    Smoothing(faces).run();
}

}  // namespace tessera::import
