#include "backends/vulkan/bvh/placed_mesh.h"

#include <cmath>
#include <glm/matrix.hpp>
#include <optional>

namespace tessera::vulkan {

namespace {

constexpr double LargestCoordinate = 1.8e18;
constexpr double UnitRoundoff = 0x1p-24;

struct Rows {
    glm::vec4 x, y, z;  // object from world
};

std::optional<Rows> inverse_of(const PlacedMesh& placed) {
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

float outward(double value, double direction) {
    return std::nextafter(static_cast<float>(value), static_cast<float>(direction));
}

}  // namespace

// Around the mesh as rays see it: their way to the object's space is rounded, 6 roundings of what is summed
// up there, and as many of the transform that it inverts.
Box world_box(const PlacedMesh& placed) {
    if (placed.box.empty() || !inverse_of(placed)) return {};
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low), size(0.0);
    const glm::dmat3 linear(placed.linear);
    const glm::dmat3 sizes(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
    for (unsigned i = 0; i < 8; ++i) {
        const glm::dvec3 corner((i & 1u) ? placed.box.low.x : placed.box.high.x,
                                (i & 2u) ? placed.box.low.y : placed.box.high.y,
                                (i & 4u) ? placed.box.low.z : placed.box.high.z);
        const glm::dvec3 world = linear * corner + glm::dvec3(placed.translation);
        low = glm::min(low, world);
        high = glm::max(high, world);
        size = glm::max(size, sizes * glm::abs(corner) + glm::abs(glm::dvec3(placed.translation)));
    }
    const glm::dvec3 margin = 12.0 * UnitRoundoff * size;
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = outward(low[axis] - margin[axis], -INFINITY);
        box.high[axis] = outward(high[axis] + margin[axis], INFINITY);
        if (!(box.low[axis] > -LargestCoordinate && box.high[axis] < LargestCoordinate)) return {};
    }
    return box;
}

shading::BvhInstance record_of(const PlacedMesh& placed, std::uint32_t number) {
    const Rows rows = inverse_of(placed).value();
    return {.object_x = rows.x,
            .object_y = rows.y,
            .object_z = rows.z,
            .nodes = placed.nodes,
            .triangles = placed.triangles,
            .instance = number,
            .flags = placed.alpha_tested ? shading::BvhAlphaTested : 0u,
            .layers = placed.layers,
            .unused = {}};
}

}  // namespace tessera::vulkan
