#include "backends/vulkan/bvh/quantise.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tessera::vulkan {

namespace {

using shading::BvhNode;
using shading::BvhWidth;

constexpr double MaxStep = 255.0;

float rounded_down(double value) {
    const auto nearest = static_cast<float>(value);
    return nearest <= value ? nearest : std::nextafter(nearest, -std::numeric_limits<float>::infinity());
}

glm::uvec2& plane(BvhNode& node, int axis, bool high) {
    const std::array<glm::uvec2*, 6> planes{&node.low_x,  &node.low_y,  &node.low_z,
                                            &node.high_x, &node.high_y, &node.high_z};
    return *planes[static_cast<std::size_t>(axis) + (high ? 3 : 0)];
}

struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -low;
};

// The frame of one axis that covers the range.
struct Axis {
    float origin;
    int exponent;  // biased
    double step;

    explicit Axis(const Range& range) {
        // Smallest power of two whose 255 steps, less both margins, span the range; larger if rounding of the
        // origin requires it.
        exponent =
            std::clamp(std::ilogb(std::max((range.high - range.low) / MaxStep, 0x1p-126)) + 127, 1, 254);
        for (;; ++exponent) {
            step = std::ldexp(1.0, exponent - 127);
            origin = rounded_down(range.low - MarginOfStep * step);
            if ((range.high - origin) / step + MarginOfStep <= MaxStep || exponent == 254) return;
        }
    }
    std::uint32_t below(double value) const {
        return static_cast<std::uint32_t>(std::max(0.0, std::floor((value - origin) / step - MarginOfStep)));
    }
    std::uint32_t above(double value) const {
        return static_cast<std::uint32_t>(
            std::min(MaxStep, std::ceil((value - origin) / step + MarginOfStep)));
    }
};

double margin(const Box& box) {
    const glm::dvec3 size = glm::dvec3(box.high) - glm::dvec3(box.low);
    return MarginOfExtent * std::max({size.x, size.y, size.z});
}

}  // namespace

void quantise(BvhNode& node, std::span<const Box> children) {
    node.frame &= 0xff000000u;
    for (int axis = 0; axis < 3; ++axis) {
        Range range;
        for (const Box& child : children) {
            if (child.empty()) continue;
            range.low = std::min(range.low, child.low[axis] - margin(child));
            range.high = std::max(range.high, child.high[axis] + margin(child));
        }
        if (!(range.low <= range.high)) range = {0.0, 0.0};
        const Axis frame(range);
        node.origin[axis] = frame.origin;
        node.frame |= static_cast<std::uint32_t>(frame.exponent) << (8 * axis);
        glm::uvec2 low{0xffffffffu}, high{0u};
        for (std::uint32_t slot = 0; slot < children.size(); ++slot) {
            const Box& child = children[slot];
            if (child.empty()) continue;
            const std::uint32_t shift = 8u * (slot % 4);
            low[slot / 4] ^= (0xffu ^ frame.below(child.low[axis] - margin(child))) << shift;
            high[slot / 4] |= frame.above(child.high[axis] + margin(child)) << shift;
        }
        plane(node, axis, false) = low;
        plane(node, axis, true) = high;
    }
}

PreciseBox quantised_box(const BvhNode& node, std::uint32_t slot) {
    PreciseBox box;
    BvhNode copy = node;
    for (int axis = 0; axis < 3; ++axis) {
        const double step = std::ldexp(1.0, static_cast<int>(node.frame >> (8 * axis) & 0xffu) - 127);
        const std::uint32_t shift = 8u * (slot % 4);
        box.low[axis] = node.origin[axis] + step * (plane(copy, axis, false)[slot / 4] >> shift & 0xffu);
        box.high[axis] = node.origin[axis] + step * (plane(copy, axis, true)[slot / 4] >> shift & 0xffu);
    }
    return box;
}

}  // namespace tessera::vulkan
