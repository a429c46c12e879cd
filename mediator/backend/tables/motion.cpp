#include <algorithm>

#include "mediator/backend/tables/parts.h"

namespace tessera::backend {

int add_motion(SceneTables& tables, const glm::dmat4& beginning, std::span<const glm::dmat4> steps) {
    if (steps.empty()) return -1;
    shading::Motion motion{.first_key = static_cast<std::uint32_t>(tables.transform_keys.size()),
                           .key_intervals = static_cast<std::uint32_t>(steps.size()),
                           .max_abs_linear = 0.0f,
                           .max_abs_translation = glm::vec3(0.0f)};
    const auto add = [&](const glm::dmat4& world) {
        // Relative to the origin in double, then rounded once.
        const shading::Affine3x4 transform{
            .linear = glm::mat3(glm::dmat3(world)),
            .translation = glm::vec3(glm::dvec3(world[3]) - tables.render_origin)};
        for (int column = 0; column < 3; ++column) {
            for (int row = 0; row < 3; ++row) {
                motion.max_abs_linear =
                    std::max(motion.max_abs_linear, std::abs(transform.linear[column][row]));
            }
        }
        motion.max_abs_translation = glm::max(motion.max_abs_translation, glm::abs(transform.translation));
        tables.transform_keys.push_back(transform);
    };
    add(beginning);
    for (const glm::dmat4& step : steps) add(step);
    tables.motions.push_back(motion);
    tables.scene.features |= shading::FeatureMotion;
    return static_cast<int>(tables.motions.size()) - 1;
}

std::vector<shading::Affine3x4> transform_keys_of(const SceneTables& tables,
                                                  const shading::Instance& instance) {
    if (instance.motion < 0) return {{instance.linear, instance.translation}};
    const shading::Motion& motion = tables.motions[static_cast<std::size_t>(instance.motion)];
    const auto first = tables.transform_keys.begin() + motion.first_key;
    return {first, first + motion.key_intervals + 1};
}

void add_mesh_keys(SceneTables& tables, const Mesh& source, shading::Mesh& mesh) {
    if (source.placeholder || source.motion_positions.empty()) return;
    mesh.arrays |= shading::MeshDeforms;
    mesh.first_key = static_cast<std::uint32_t>(tables.mesh_keys.size());
    mesh.key_intervals = static_cast<std::uint32_t>(source.motion_positions.size());
    const glm::vec3 max_abs = glm::max(glm::abs(source.low), glm::abs(source.high));
    mesh.max_abs_position = std::max({max_abs.x, max_abs.y, max_abs.z});
    const auto add = [&](const scene::BlobPtr& positions, const scene::BlobPtr& normals) {
        tables.mesh_keys.push_back(
            {{elements<glm::vec3>(positions).data()}, {elements<glm::vec3>(normals).data()}});
        tables.key_arrays.push_back({positions, normals});
    };
    add(source.positions, source.normals);
    for (std::size_t i = 0; i < source.motion_positions.size(); ++i) {
        add(source.motion_positions[i],
            source.motion_normals.empty() ? source.normals : source.motion_normals[i]);
    }
    tables.scene.features |= shading::FeatureMotion;
}

}  // namespace tessera::backend
