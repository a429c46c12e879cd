#include "backends/vulkan/bvh/placed_mesh.h"

#include <cmath>
#include <glm/matrix.hpp>
#include <optional>

namespace tessera::vulkan {

namespace {

constexpr double LargestPlacedCoordinate = 1.8e18;
constexpr double UnitRoundoff = 0x1p-24;

struct Rows {
    glm::vec4 x, y, z;  // object from world
};

std::optional<Rows> inverse_of(const shading::Affine3x4& placed) {
    const glm::dmat3 inverse = glm::inverse(glm::dmat3(placed.linear));
    const glm::dvec3 translation = -(inverse * glm::dvec3(placed.translation));
    Rows rows;
    const auto fill = [&](glm::vec4& row, int i) {
        row = glm::vec4(inverse[0][i], inverse[1][i], inverse[2][i], translation[i]);
        return std::isfinite(row.x) && std::isfinite(row.y) && std::isfinite(row.z) && std::isfinite(row.w);
    };
    if (!fill(rows.x, 0) || !fill(rows.y, 1) || !fill(rows.z, 2)) return std::nullopt;
    return rows;
}

// Bound on the rounding error of the transform to object space by an inverse in floats, in roundings of world
// coordinates: 9 of the cofactors and 6 of the determinant, relative to the determinant (motion_error in
// shading/motion.h), and 8 of the interpolation.
double roundings_of(const shading::Affine3x4& placed) {
    const glm::dmat3 m(placed.linear);
    const glm::dmat3 sizes(glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2]));
    const auto across = [](const glm::dvec3& v, const glm::dvec3& w) {
        return glm::dvec3(v.y * w.z + v.z * w.y, v.z * w.x + v.x * w.z, v.x * w.y + v.y * w.x);
    };
    const glm::dvec3 x = across(sizes[1], sizes[2]), y = across(sizes[2], sizes[0]),
                     z = across(sizes[0], sizes[1]);
    const glm::dmat3 back = sizes * glm::transpose(glm::dmat3(x, y, z));
    double most = 0.0;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) most = std::max(most, back[column][row]);
    }
    const double determinant = std::fabs(glm::determinant(m));
    return determinant > 0.0 ? 8.0 + (9.0 * 3.0 * most + 6.0 * glm::dot(sizes[0], x)) / determinant : 12.0;
}

float outward(double value, double direction) {
    return std::nextafter(static_cast<float>(value), static_cast<float>(direction));
}

}  // namespace

// Conservative bounds for rays: their transform to object space has 6 roundings of the summed terms, and as many
// of the inverted transform.
Box box_at(const Box& mesh, const shading::Affine3x4& placed, double roundings) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low), size(0.0);
    const glm::dmat3 linear(placed.linear);
    const glm::dmat3 sizes(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
    for (unsigned i = 0; i < 8; ++i) {
        const glm::dvec3 corner((i & 1u) ? mesh.low.x : mesh.high.x, (i & 2u) ? mesh.low.y : mesh.high.y,
                                (i & 4u) ? mesh.low.z : mesh.high.z);
        const glm::dvec3 world = linear * corner + glm::dvec3(placed.translation);
        low = glm::min(low, world);
        high = glm::max(high, world);
        size = glm::max(size, sizes * glm::abs(corner) + glm::abs(glm::dvec3(placed.translation)));
    }
    const glm::dvec3 margin = roundings * UnitRoundoff * size;
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = outward(low[axis] - margin[axis], -INFINITY);
        box.high[axis] = outward(high[axis] + margin[axis], INFINITY);
        if (!(box.low[axis] > -LargestPlacedCoordinate && box.high[axis] < LargestPlacedCoordinate))
            return {};
    }
    return box;
}

Box world_box(const PlacedMesh& placed) {
    if (placed.box.empty()) return {};
    const shading::Affine3x4 still{placed.linear, placed.translation};
    if (placed.transform_keys.empty()) return inverse_of(still) ? box_at(placed.box, still, 12.0) : Box();
    Box all;
    bool can_be_hit = false;
    double roundings = 12.0;
    for (const shading::Affine3x4& place : placed.transform_keys) {
        can_be_hit = can_be_hit || inverse_of(place);
        roundings = std::max(roundings, 12.0 + roundings_of(place));
    }
    for (const shading::Affine3x4& place : placed.transform_keys) {
        const Box box = box_at(placed.box, place, roundings);
        if (box.empty()) return {};
        all.add(box);
    }
    return can_be_hit ? all : Box();
}

std::array<glm::vec4, shading::BvhTransformItems> rows_of(const shading::Affine3x4& place) {
    const auto row = [&](int i) {
        return glm::vec4(place.linear[0][i], place.linear[1][i], place.linear[2][i], place.translation[i]);
    };
    return {row(0), row(1), row(2)};
}

shading::BvhInstance record_of(const PlacedMesh& placed, std::uint32_t number, std::uint32_t places) {
    const bool moves = !placed.transform_keys.empty();
    const Rows rows = moves ? Rows() : inverse_of({placed.linear, placed.translation}).value();
    return {.object_x = rows.x,
            .object_y = rows.y,
            .object_z = rows.z,
            .nodes = placed.nodes,
            .triangles = placed.triangles,
            .instance = number,
            .flags = (placed.alpha_tested ? shading::BvhAlphaTested : 0u) |
                     (moves || placed.mesh_key_intervals > 0 ? shading::BvhMoves : 0u),
            .layers = placed.layers,
            .transform_keys = places,
            .key_intervals = moves ? static_cast<std::uint32_t>(placed.transform_keys.size()) - 1 : 0u,
            .mesh_key_intervals = placed.mesh_key_intervals};
}

}  // namespace tessera::vulkan
