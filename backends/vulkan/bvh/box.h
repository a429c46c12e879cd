#pragma once

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace tessera::vulkan {

// Axis-aligned and closed. Empty by default.
struct Box {
    glm::vec3 low{std::numeric_limits<float>::infinity()};
    glm::vec3 high{-std::numeric_limits<float>::infinity()};

    bool empty() const { return !(low.x <= high.x); }
    void add(const glm::vec3& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    void add(const Box& box) {
        low = glm::min(low, box.low);
        high = glm::max(high, box.high);
    }
    // Half the surface area; 0 if empty.
    double area() const {
        if (empty()) return 0.0;
        const glm::dvec3 d = glm::dvec3(high) - glm::dvec3(low);
        return d.x * d.y + d.y * d.z + d.z * d.x;
    }
};

}  // namespace tessera::vulkan
