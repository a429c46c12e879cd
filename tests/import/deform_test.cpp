#include "client/import/deform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "mediator/base/error.h"
#include "mediator/base/random.h"

namespace tessera::import {
namespace {

DeformableMesh triangle() {
    DeformableMesh mesh;
    mesh.rest.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.rest.normals.assign(3, {0, 0, 1});
    mesh.rest.tangents.assign(3, {1, 0, 0, 1});
    mesh.rest.indices = {0, 1, 2};
    return mesh;
}

TEST(Deform, TargetsAddByTheirWeights) {
    DeformableMesh mesh = triangle();
    mesh.targets.resize(2);
    mesh.targets[0].positions = {{0, 0, 2}, {0, 0, 0}, {1, 0, 0}};
    mesh.targets[0].normals = {{3, 0, 3}, {0, 0, 0}, {0, 0, 0}};
    mesh.targets[1].positions = {{0, 4, 0}, {0, 0, 0}, {0, 0, 0}};
    mesh.targets[1].tangents = {{0, 2, 0}, {0, 0, 0}, {0, 0, 0}};
    const MeshData deformed = deform(mesh, std::vector<double>{0.5, -0.25}, {});
    EXPECT_EQ(deformed.positions[0], glm::vec3(0, -1, 1));
    EXPECT_EQ(deformed.positions[1], glm::vec3(1, 0, 0));
    EXPECT_EQ(deformed.positions[2], glm::vec3(0.5, 1, 0));
    EXPECT_NEAR(glm::distance(deformed.normals[0], glm::normalize(glm::vec3(1.5, 0, 2.5))), 0.0, 1e-6);
    EXPECT_NEAR(glm::distance(glm::vec3(deformed.tangents[0]), glm::normalize(glm::vec3(1, -0.5, 0))), 0.0,
                1e-6);
    EXPECT_EQ(deform(mesh, std::vector<double>{0.5}, {}).positions[0], glm::vec3(0, 0, 1))
        << "a target without a weight counts nothing";
}

TEST(Deform, AVertexOfTwoJointsIsBlended) {
    DeformableMesh mesh = triangle();
    mesh.sets.push_back(
        {{{0, 1, 0, 0}, {0, 1, 0, 0}, {1, 0, 0, 0}}, {{1, 0, 0, 0}, {0.25, 0.75, 0, 0}, {1, 0, 0, 0}}});
    const std::vector<glm::dmat4> joints{glm::translate(glm::dmat4(1.0), {0.0, 0.0, 4.0}),
                                         glm::rotate(glm::dmat4(1.0), glm::radians(90.0), {0.0, 1.0, 0.0})};
    const MeshData deformed = deform(mesh, {}, joints);
    EXPECT_NEAR(glm::distance(deformed.positions[0], {0, 0, 4}), 0.0, 1e-6);
    // (1, 0, 4) and (0, 0, -1), the latter with weight 3/4.
    EXPECT_NEAR(glm::distance(deformed.positions[1], {0.25, 0, 0.25}), 0.0, 1e-6);
    EXPECT_NEAR(glm::distance(deformed.positions[2], {0, 1, 0}), 0.0, 1e-6);
    EXPECT_NEAR(glm::distance(deformed.normals[2], {1, 0, 0}), 0.0, 1e-6);
    EXPECT_NEAR(glm::distance(deformed.tangents[2], {0, 0, -1, 1}), 0.0, 1e-6);
}

glm::dmat4 some_matrix(CounterRandom& random) {
    glm::dmat4 matrix(1.0);
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row) matrix[column][row] = 2.0 * random.uniform() - 1.0;
    }
    return matrix;
}

// Blends points instead of matrices; normals are cross products of deformed edges.
TEST(Deform, AgreesWithBruteForceForEightJointsPerVertex) {
    CounterRandom random(4711);
    int mirrored = 0;
    for (int round = 0; round < 200; ++round) {
        std::vector<glm::dmat4> joints;
        for (int i = 0; i < 9; ++i) joints.push_back(some_matrix(random));
        DeformableMesh mesh = triangle();
        mesh.sets.resize(2);
        for (JointSet& set : mesh.sets) {
            for (int v = 0; v < 3; ++v) {
                set.joints.emplace_back(random.below(9), random.below(9), random.below(9), random.below(9));
                set.weights.emplace_back(random.uniform(), random.uniform(), random.uniform(),
                                         random.uniform());
            }
        }
        normalize_weights(mesh.sets);
        const MeshData deformed = deform(mesh, {}, joints);
        for (int v = 0; v < 3; ++v) {
            const auto vertex = static_cast<std::size_t>(v);
            const auto blend = [&](const glm::dvec4& point) {
                glm::dvec3 sum(0.0);
                for (const JointSet& set : mesh.sets) {
                    for (int k = 0; k < 4; ++k)
                        sum += double(set.weights[vertex][k]) *
                               glm::dvec3(joints[set.joints[vertex][k]] * point);
                }
                return sum;
            };
            const glm::dvec3 position = blend(glm::dvec4(glm::dvec3(mesh.rest.positions[vertex]), 1.0));
            EXPECT_NEAR(glm::distance(glm::dvec3(deformed.positions[vertex]), position), 0.0, 1e-6);
            const glm::dvec3 x = blend({1, 0, 0, 0}), y = blend({0, 1, 0, 0}), z = blend({0, 0, 1, 0});
            const double side = glm::dot(glm::cross(x, y), z) < 0.0 ? -1.0 : 1.0;
            mirrored += side < 0.0 ? 1 : 0;
            EXPECT_NEAR(
                glm::distance(glm::dvec3(deformed.normals[vertex]), side * glm::normalize(glm::cross(x, y))),
                0.0, 1e-5);
            EXPECT_NEAR(glm::distance(glm::dvec3(deformed.tangents[vertex]), glm::normalize(x)), 0.0, 1e-5);
            EXPECT_EQ(double(deformed.tangents[vertex].w), side);
        }
    }
    EXPECT_GT(mirrored, 100) << "both sides are to be seen";
}

TEST(Deform, WeightsAreDividedByTheirSum) {
    std::vector<JointSet> sets{{{{1, 2, 3, 4}, {5, 6, 7, 8}}, {{1, 1, 2, 0}, {0, 0, 0, 0}}},
                               {{{1, 2, 3, 4}, {5, 6, 7, 8}}, {{4, 0, 0, 0}, {0, 0, 0, 0}}}};
    normalize_weights(sets);
    EXPECT_EQ(sets[0].weights[0], glm::vec4(0.125, 0.125, 0.25, 0));
    EXPECT_EQ(sets[1].weights[0], glm::vec4(0.5, 0, 0, 0));
    EXPECT_EQ(sets[0].weights[1], glm::vec4(1, 0, 0, 0)) << "without any, the first joint has it";
    for (const float bad :
         {-0.5f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        std::vector<JointSet> wrong{{{{0, 0, 0, 0}}, {{1, bad, 0, 0}}}};
        EXPECT_THROW(normalize_weights(wrong), Error) << bad;
    }
}

TEST(Deform, FlatNormalsAreThoseOfTheDeformedTriangles) {
    DeformableMesh mesh = triangle();
    mesh.is_flat = true;
    mesh.targets.push_back({{{0, 0, 0}, {0, 0, 1}, {0, 0, 0}}, {}, {}});
    const MeshData deformed = deform(mesh, std::vector<double>{1.0}, {});
    for (const glm::vec3& normal : deformed.normals)
        EXPECT_NEAR(glm::distance(normal, glm::normalize(glm::vec3(-1, 0, 1))), 0.0, 1e-6);
}

TEST(Deform, PosesThatAreNotFiniteAreRejected) {
    DeformableMesh mesh = triangle();
    mesh.targets.push_back({{{1e38f, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {}, {}});
    EXPECT_THROW(deform(mesh, std::vector<double>{100.0}, {}), Error);
}

}  // namespace
}  // namespace tessera::import
