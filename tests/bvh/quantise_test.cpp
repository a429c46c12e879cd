// 8-bit quantised boxes enclose the exact boxes, also under the rounding of the ray test.
#include "backends/vulkan/bvh/quantise.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "mediator/base/random.h"
#include "mediator/shading/bvh_node.h"

namespace tessera::vulkan {

namespace {

using shading::BvhNode;

struct Node {
    BvhNode node{};
    std::array<Box, shading::BvhWidth> boxes;
    std::uint32_t count = 0;
};

float uniform(CounterRandom& random, float low, float high) {
    return low + (high - low) * static_cast<float>(random.uniform());
}

// Of any size, flat or thin in some axes, near the origin or far from it.
Node random_node(CounterRandom& random) {
    Node made;
    made.count = static_cast<std::uint32_t>(1 + random.below(shading::BvhWidth));
    const float size = std::exp2(uniform(random, -40.0f, 40.0f));
    const float away = random.below(2) == 0 ? 0.0f : size * std::exp2(uniform(random, 0.0f, 20.0f));
    glm::vec3 shape(1.0f);
    for (int axis = 0; axis < 3; ++axis) {
        if (random.below(3) == 0) shape[axis] = random.below(2) == 0 ? 0.0f : 1e-5f;
    }
    const glm::vec3 centre(uniform(random, -away, away), uniform(random, -away, away),
                           uniform(random, -away, away));
    for (std::uint32_t i = 0; i < made.count; ++i) {
        const auto point = [&] {
            return centre +
                   shape * size *
                       glm::vec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
        };
        made.boxes[i].add(point());
        made.boxes[i].add(point());
    }
    quantise(made.node, made.boxes);
    return made;
}

TEST(Quantise, EnclosesTheExactBoxAndItsMargin) {
    CounterRandom random(41);
    for (int round = 0; round < 50'000; ++round) {
        const Node made = random_node(random);
        for (std::uint32_t i = 0; i < made.count; ++i) {
            const PreciseBox around = quantised_box(made.node, i);
            const glm::dvec3 size = glm::dvec3(made.boxes[i].high) - glm::dvec3(made.boxes[i].low);
            const double margin = MarginOfExtent * std::max({size.x, size.y, size.z});
            for (int axis = 0; axis < 3; ++axis) {
                const double step = std::ldexp(1.0, int(made.node.frame >> (8 * axis) & 0xffu) - 127);
                ASSERT_LE(around.low[axis], made.boxes[i].low[axis] - margin - 0.99 * MarginOfStep * step);
                ASSERT_GE(around.high[axis], made.boxes[i].high[axis] + margin + 0.99 * MarginOfStep * step);
            }
        }
    }
}

// Tight: a plane is off by a step and a bit, a step is a 127th of the node or less, or of the rounding of its
// origin.
TEST(Quantise, IsTight) {
    CounterRandom random(42);
    for (int round = 0; round < 20'000; ++round) {
        const Node made = random_node(random);
        Box whole;
        double largest = 0.0;
        for (const Box& box : made.boxes) {
            if (box.empty()) continue;
            whole.add(box);
            const glm::dvec3 size = glm::dvec3(box.high) - glm::dvec3(box.low);
            largest = std::max({largest, size.x, size.y, size.z});
        }
        for (int axis = 0; axis < 3; ++axis) {
            const double step = std::ldexp(1.0, int(made.node.frame >> (8 * axis) & 0xffu) - 127);
            const double extent =
                double(whole.high[axis]) - double(whole.low[axis]) + 2 * MarginOfExtent * largest;
            const double ulp = std::fabs(made.node.origin[axis]) * 0x1p-22;
            EXPECT_LE(step, std::max((extent + ulp) / 127.0, 0x1p-126));
            for (std::uint32_t i = 0; i < made.count; ++i) {
                const double slack = 1.01 * step + MarginOfExtent * largest;
                EXPECT_GE(quantised_box(made.node, i).low[axis], made.boxes[i].low[axis] - slack);
                EXPECT_LE(quantised_box(made.node, i).high[axis], made.boxes[i].high[axis] + slack);
            }
        }
    }
}

// Rays at points of the exact boxes, their corners and edges included, enter the quantised ones before and
// leave them behind the point.
TEST(Quantise, RaysThatHitTheBoxEnterTheQuantisedBox) {
    CounterRandom random(43);
    for (int round = 0; round < 100'000; ++round) {
        const Node made = random_node(random);
        const auto slot = static_cast<std::uint32_t>(random.below(made.count));
        const Box& box = made.boxes[slot];
        glm::vec3 target;
        for (int axis = 0; axis < 3; ++axis) {
            const std::uint64_t where = random.below(3);
            target[axis] = where == 0   ? box.low[axis]
                           : where == 1 ? box.high[axis]
                                        : glm::clamp(uniform(random, box.low[axis], box.high[axis]),
                                                     box.low[axis], box.high[axis]);
        }
        if (box.low == box.high) continue;  // no triangle
        // The ray passes exactly through target: the offset is a power of two times the direction.
        const glm::vec3 size = box.high - box.low;
        const float distance = std::max({size.x, size.y, size.z}) * std::exp2(uniform(random, -2.0f, 8.0f));
        glm::vec3 origin = target + distance * glm::vec3(uniform(random, -1, 1), uniform(random, -1, 1),
                                                         uniform(random, -1, 1));
        if (random.below(4) == 0)
            origin[static_cast<int>(random.below(3))] = target[static_cast<int>(random.below(3))];
        const glm::dvec3 offset = glm::dvec3(target) - glm::dvec3(origin);
        const glm::vec3 direction(offset);
        if (direction == glm::vec3(0.0f)) continue;
        if (glm::any(glm::notEqual(glm::dvec3(direction), offset))) continue;
        std::array<glm::uvec4, shading::BvhNodeItems> items;
        std::memcpy(items.data(), &made.node, sizeof made.node);
        const auto meets = [&](float near, float far) {
            const shading::BvhVisit visit =
                shading::bvh_visit(shading::bvh_ray(origin, direction), items[0], items[1], items[2],
                                   items[3], items[4], near, far, made.count, shading::BvhClosest);
            for (std::uint32_t list = visit.list & shading::BvhSlots; list > 1; list >>= 3) {
                if ((list & 7u) == slot) return true;
            }
            return false;
        };
        ASSERT_TRUE(meets(0.0f, 1.0f));
        ASSERT_TRUE(meets(0.0f, INFINITY));
        ASSERT_TRUE(meets(1.0f, INFINITY));
    }
}

}  // namespace

}  // namespace tessera::vulkan
