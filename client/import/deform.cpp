#include "client/import/deform.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "mediator/base/error.h"

namespace tessera::import {
namespace {

glm::vec3 unit_or(const glm::dvec3& vector, const glm::vec3& otherwise) {
    const double length = glm::length(vector);
    return length > 0.0 && std::isfinite(length) ? glm::vec3(vector / length) : otherwise;
}

// One vertex, in double precision, rounded once at the end.
struct Vertex {
    glm::dvec3 position{0.0}, normal{0.0}, tangent{0.0};
    double handedness = 1.0;
};

void morph(Vertex& vertex, const DeformableMesh& mesh, std::span<const double> weights, std::size_t i) {
    for (std::size_t k = 0; k < std::min(weights.size(), mesh.targets.size()); ++k) {
        if (weights[k] == 0.0) continue;
        const MorphTarget& target = mesh.targets[k];
        if (!target.positions.empty()) vertex.position += weights[k] * glm::dvec3(target.positions[i]);
        if (!target.normals.empty()) vertex.normal += weights[k] * glm::dvec3(target.normals[i]);
        if (!target.tangents.empty()) vertex.tangent += weights[k] * glm::dvec3(target.tangents[i]);
    }
}

void apply_skin(Vertex& vertex, const DeformableMesh& mesh, std::span<const glm::dmat4> joints,
                std::size_t i) {
    if (mesh.sets.empty()) return;
    glm::dmat4 blend(0.0);
    for (const JointSet& set : mesh.sets) {
        for (int k = 0; k < 4; ++k) {
            const auto weight = static_cast<double>(set.weights[i][k]);
            if (weight != 0.0) blend += weight * joints[set.joints[i][k]];
        }
    }
    const glm::dmat3 linear(blend);
    // The cofactor matrix is the inverse transpose times the determinant, and defined for singular matrices
    // as well.
    const glm::dmat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                               glm::cross(linear[0], linear[1]));
    const double side = glm::determinant(linear) < 0.0 ? -1.0 : 1.0;
    vertex.position = glm::dvec3(blend * glm::dvec4(vertex.position, 1.0));
    vertex.normal = side * (cofactors * vertex.normal);
    vertex.tangent = linear * vertex.tangent;
    vertex.handedness *= side;
}

void make_normals_flat(MeshData& mesh) {
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const glm::dvec3 a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
            c(mesh.positions[mesh.indices[i + 2]]);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        for (std::size_t k = 0; k < 3; ++k) {
            glm::vec3& of_vertex = mesh.normals[mesh.indices[i + k]];
            of_vertex = unit_or(normal, of_vertex);
        }
    }
}

template <class T>
void spread(std::vector<T>& values, std::span<const std::uint32_t> from) {
    if (values.empty()) return;
    std::vector<T> spread;
    spread.reserve(from.size());
    for (const std::uint32_t vertex : from) spread.push_back(values[vertex]);
    values = std::move(spread);
}

}  // namespace

void normalize_weights(std::vector<JointSet>& sets) {
    for (std::size_t i = 0; !sets.empty() && i < sets[0].weights.size(); ++i) {
        double sum = 0.0;
        for (const JointSet& set : sets) {
            for (int k = 0; k < 4; ++k) {
                const float weight = set.weights[i][k];
                if (!(weight >= 0.0f) || !std::isfinite(weight)) {
                    throw Error(ErrorCode::InvalidInput,
                                "a weight of vertex " + std::to_string(i) + " is negative or not finite");
                }
                sum += double(weight);
            }
        }
        for (JointSet& set : sets) {
            if (sum > 0.0) set.weights[i] = glm::vec4(glm::dvec4(set.weights[i]) / sum);
        }
        if (!(sum > 0.0)) sets[0].weights[i].x = 1.0f;
    }
}

void remap_vertices(DeformableMesh& mesh, std::span<const std::uint32_t> from) {
    for (MorphTarget& target : mesh.targets) {
        spread(target.positions, from);
        spread(target.normals, from);
        spread(target.tangents, from);
    }
    for (JointSet& set : mesh.sets) {
        spread(set.joints, from);
        spread(set.weights, from);
    }
}

MeshData deform(const DeformableMesh& mesh, std::span<const double> weights,
                std::span<const glm::dmat4> joints) {
    MeshData deformed = mesh.rest;
    for (std::size_t i = 0; i < deformed.positions.size(); ++i) {
        Vertex vertex{.position = glm::dvec3(deformed.positions[i])};
        if (!deformed.normals.empty()) vertex.normal = glm::dvec3(deformed.normals[i]);
        if (!deformed.tangents.empty()) vertex.tangent = glm::dvec3(deformed.tangents[i]);
        morph(vertex, mesh, weights, i);
        apply_skin(vertex, mesh, joints, i);
        deformed.positions[i] = glm::vec3(vertex.position);
        for (int k = 0; k < 3; ++k) {
            if (!std::isfinite(deformed.positions[i][k])) {
                throw Error(ErrorCode::InvalidInput, "the pose moves vertex " + std::to_string(i) +
                                                         " to a position that is not finite");
            }
        }
        if (!deformed.normals.empty()) deformed.normals[i] = unit_or(vertex.normal, deformed.normals[i]);
        if (!deformed.tangents.empty()) {
            const glm::vec4 rest = deformed.tangents[i];
            deformed.tangents[i] = glm::vec4(unit_or(vertex.tangent, glm::vec3(rest)),
                                             rest.w * static_cast<float>(vertex.handedness));
        }
    }
    if (mesh.is_flat) make_normals_flat(deformed);
    return deformed;
}

}  // namespace tessera::import
