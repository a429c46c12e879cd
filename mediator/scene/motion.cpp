#include "mediator/scene/motion.h"

#include <algorithm>
#include <numeric>

namespace tessera::scene {

namespace {

glm::dmat4 matrix_at(const Transform& transform, double time) {
    const std::size_t steps = transform.motion.size();
    if (steps == 0) return transform.matrix;
    const auto key = [&](std::size_t i) { return i == 0 ? transform.matrix : transform.motion[i - 1]; };
    const double at = time * static_cast<double>(steps);
    const std::size_t step = std::min(static_cast<std::size_t>(at), steps - 1);
    const double fraction = at - static_cast<double>(step);
    // Exact at both ends.
    return fraction == 1.0 ? key(step + 1) : key(step) + (key(step + 1) - key(step)) * fraction;
}

std::size_t key_interval_count(std::span<const Transform* const> moving) {
    if (moving.size() == 1) return moving.front()->motion.size();
    std::size_t common_multiple = 1, max_count = 1;
    for (const Transform* transform : moving) {
        common_multiple = std::min(std::lcm(common_multiple, transform->motion.size()), MaxMotion + 1);
        max_count = std::max(max_count, transform->motion.size());
    }
    const std::size_t base_count = common_multiple <= MaxMotion ? common_multiple : max_count;
    return MaxMotion / base_count * base_count;
}

}  // namespace

std::vector<glm::dmat4> motion_along(const Scene& scene, std::span<const ObjectId> path) {
    std::vector<const Transform*> transforms, moving;
    for (const ObjectId id : path) {
        const auto* transform = scene.find_as<Transform>(id);
        if (!transform) continue;
        transforms.push_back(transform);
        const bool moves = std::any_of(transform->motion.begin(), transform->motion.end(),
                                       [&](const glm::dmat4& step) { return step != transform->matrix; });
        if (moves) moving.push_back(transform);
    }
    std::vector<glm::dmat4> motion;
    if (moving.empty()) return motion;
    const std::size_t steps = key_interval_count(moving);
    for (std::size_t i = 1; i <= steps; ++i) {
        const double time = static_cast<double>(i) / static_cast<double>(steps);
        glm::dmat4 world(1.0);
        for (const Transform* transform : transforms) world = world * matrix_at(*transform, time);
        motion.push_back(world);
    }
    return motion;
}

}  // namespace tessera::scene
