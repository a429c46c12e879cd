#include "client/import/scene_stats.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <set>

#include "client/import/limits.h"

namespace tessera::import {
namespace {

class StatsCollector {
  public:
    explicit StatsCollector(SceneBuilder& builder)
        : builder_(builder), stats_{.emissive_lights = EmissiveLights(builder)} {}

    SceneStats run() {
        enter(builder_.result().root.children, glm::dmat4(1.0));
        while (!stack_.empty()) {
            const Visit current = stack_.back();
            stack_.pop_back();
            visit(current);
        }
        for (const ObjectId transform : degenerate_) {
            if (!visible_.contains(transform)) remove_geometries(transform);
        }
        std::sort(cameras_.begin(), cameras_.end(),
                  [](const auto& a, const auto& b) { return a.first < b.first; });
        for (auto& [unused, camera] : cameras_) stats_.cameras.push_back(std::move(camera));
        builder_.result().counts.lights = stats_.lights.size();
        builder_.result().counts.emissive_geometries = emissive_.size();
        return std::move(stats_);
    }

  private:
    struct Visit {
        ObjectId transform;
        glm::dmat4 parent{1.0};
    };

    // Reversed, as the stack is last in, first out.
    void enter(const std::vector<ObjectId>& children, const glm::dmat4& parent) {
        for (auto child = children.rbegin(); child != children.rend(); ++child) {
            if (std::holds_alternative<scene::Transform>(object(*child))) stack_.push_back({*child, parent});
        }
    }

    void visit(const Visit& current) {
        if (++visits_ > MaxInstances) {
            throw Error(ErrorCode::InvalidInput, "it has more than " + std::to_string(MaxInstances) +
                                                     " transform instances: split the scene");
        }
        const auto& transform = builder_.get<scene::Transform>(current.transform);
        const glm::dmat4 world = current.parent * transform.matrix;
        const bool visible = has_volume(world);
        (visible ? visible_ : degenerate_).insert(current.transform);
        for (const ObjectId child : transform.children) {
            const scene::Object& below = object(child);
            if (std::holds_alternative<scene::Geometry>(below) && visible) place_geometry(child, world);
            if (std::holds_alternative<scene::Light>(below)) stats_.lights.push_back({child, world});
            if (const auto* camera = std::get_if<scene::Camera>(&below)) place_camera(child, *camera, world);
        }
        enter(transform.children, world);
    }

    void remove_geometries(ObjectId id) {
        auto& transform = builder_.get<scene::Transform>(id);
        const auto stays = [&](ObjectId child) {
            return !std::holds_alternative<scene::Geometry>(object(child));
        };
        const auto unseen =
            std::stable_partition(transform.children.begin(), transform.children.end(), stays);
        if (unseen != transform.children.end()) {
            builder_.result().without_volume[id] = {unseen, transform.children.end()};
            transform.children.erase(unseen, transform.children.end());
            builder_.notice("node '" + transform.name +
                            "': its mesh is not drawn, since the node's transform is degenerate");
        }
    }

    const scene::Object& object(ObjectId id) const { return builder_.object(id); }

    void place_geometry(ObjectId id, const glm::dmat4& world) {
        if (++builder_.result().counts.instances > MaxInstances) {
            throw Error(ErrorCode::InvalidInput, "it has more than " + std::to_string(MaxInstances) +
                                                     " mesh instances: split the scene");
        }
        stats_.bounds.add(builder_.bounds(id), world);
        const auto& geometry = builder_.get<scene::Geometry>(id);
        const auto is_emissive = [&](ObjectId shading_object) {
            return shading_object && emits(object(shading_object));
        };
        if (is_emissive(geometry.material) || is_emissive(geometry.medium)) {
            emissive_.insert(id);
            stats_.emissive_lights.add(id, world);
        }
    }

    void place_camera(ObjectId id, const scene::Camera& camera, glm::dmat4 world) {
        if (!placed_cameras_.insert(id).second) return;
        if (make_rigid(world)) {
            cameras_.emplace_back(id, CameraInfo{camera.name, world, camera});
        } else {
            builder_.notice("camera '" + camera.name + "' is not used: its transform is degenerate");
        }
    }

    SceneBuilder& builder_;
    SceneStats stats_;
    std::vector<Visit> stack_;
    std::vector<std::pair<ObjectId, CameraInfo>> cameras_;
    std::set<ObjectId> emissive_, placed_cameras_;
    std::set<ObjectId> visible_, degenerate_;  // transforms with a regular, or a degenerate, instance
    std::uint64_t visits_ = 0;
};

}  // namespace

bool emits(const scene::Object& shading_object) {
    if (const auto* material = std::get_if<scene::Material>(&shading_object); material && material->unlit)
        return false;
    return std::visit(
        [](const auto& value) {
            if constexpr (requires { value.emission; }) return value.emission != glm::vec3(0.0f);
            return false;
        },
        shading_object);
}

bool has_volume(const glm::dmat4& matrix) {
    const glm::dmat3 linear(matrix);
    const double lengths = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
    const double volume = std::abs(glm::determinant(linear));
    const bool far = !(glm::length(glm::dvec3(matrix[3])) < 1e18) || !(lengths < 1e36);
    return !far && lengths > 1e-36 && volume > 1e-12 * lengths;
}

bool make_rigid(glm::dmat4& matrix) {
    const glm::dvec3 up(matrix[1]), back(matrix[2]), position(matrix[3]);
    const glm::dvec3 right = glm::cross(up, back);
    const double size = glm::length(back) * glm::length(up);
    if (!(size > 0.0) || !std::isfinite(size) || !(glm::length(right) > 1e-9 * size) ||
        !(glm::length(position) < 1e18)) {
        return false;
    }
    const glm::dvec3 z = glm::normalize(back), x = glm::normalize(right);
    matrix = glm::dmat4(glm::dvec4(x, 0.0), glm::dvec4(glm::cross(z, x), 0.0), glm::dvec4(z, 0.0),
                        glm::dvec4(position, 1.0));
    return true;
}

SceneStats gather_scene_stats(SceneBuilder& builder) {
    return StatsCollector(builder).run();
}

}  // namespace tessera::import
