#include "client/import/survey.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <set>

#include "client/import/limits.h"

namespace tessera::import {
namespace {

class Walk {
  public:
    explicit Walk(SceneBuilder& builder) : builder_(builder), survey_{.glow = Glow(builder)} {}

    Survey run() {
        enter(builder_.result().root.children, glm::dmat4(1.0));
        while (!stack_.empty()) {
            const Place place = stack_.back();
            stack_.pop_back();
            visit(place);
        }
        for (const ObjectId transform : flat_) {
            if (!visible_.contains(transform)) remove_geometries(transform);
        }
        std::sort(cameras_.begin(), cameras_.end(),
                  [](const auto& a, const auto& b) { return a.first < b.first; });
        for (auto& [unused, camera] : cameras_) survey_.cameras.push_back(std::move(camera));
        builder_.result().counts.emissive_geometries = emissive_.size();
        return std::move(survey_);
    }

  private:
    struct Place {
        ObjectId transform;
        glm::dmat4 parent{1.0};
    };

    // In the order of the list: the last in goes out first.
    void enter(const std::vector<ObjectId>& children, const glm::dmat4& parent) {
        for (auto child = children.rbegin(); child != children.rend(); ++child) {
            if (std::holds_alternative<scene::Transform>(object(*child))) stack_.push_back({*child, parent});
        }
    }

    void visit(const Place& place) {
        if (++places_ > MaxInstances) {
            throw Error(ErrorCode::InvalidInput, "its transforms stand in more than " +
                                                     std::to_string(MaxInstances) +
                                                     " places: split the scene");
        }
        const auto& transform = builder_.get<scene::Transform>(place.transform);
        const glm::dmat4 world = place.parent * transform.matrix;
        const bool visible = has_volume(world);
        (visible ? visible_ : flat_).insert(place.transform);
        for (const ObjectId child : transform.children) {
            const scene::Object& below = object(child);
            if (std::holds_alternative<scene::Geometry>(below) && visible) place_geometry(child, world);
            if (std::holds_alternative<scene::Light>(below)) ++builder_.result().counts.lights;
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
                            "': its mesh is not drawn, since the node's transform leaves it no volume");
        }
    }

    const scene::Object& object(ObjectId id) const { return builder_.object(id); }

    void place_geometry(ObjectId id, const glm::dmat4& world) {
        if (++builder_.result().counts.instances > MaxInstances) {
            throw Error(ErrorCode::InvalidInput,
                        "it places more than " + std::to_string(MaxInstances) + " meshes: split the scene");
        }
        survey_.bounds.add(builder_.bounds(id), world);
        const auto& geometry = builder_.get<scene::Geometry>(id);
        const auto shines = [&](ObjectId made_of) { return made_of && emits(object(made_of)); };
        if (shines(geometry.material) || shines(geometry.medium)) {
            emissive_.insert(id);
            survey_.glow.place(id, world);
        }
    }

    void place_camera(ObjectId id, const scene::Camera& camera, glm::dmat4 world) {
        if (!placed_cameras_.insert(id).second) return;
        if (make_rigid(world)) {
            cameras_.emplace_back(id, CameraInfo{camera.name, world, camera});
        } else {
            builder_.notice("camera '" + camera.name + "' is not used: its transform has no direction");
        }
    }

    SceneBuilder& builder_;
    Survey survey_;
    std::vector<Place> stack_;
    std::vector<std::pair<ObjectId, CameraInfo>> cameras_;
    std::set<ObjectId> emissive_, placed_cameras_;
    std::set<ObjectId> visible_, flat_;  // transforms by how they stand in some place
    std::uint64_t places_ = 0;
};

}  // namespace

bool emits(const scene::Object& made_of) {
    if (const auto* material = std::get_if<scene::Material>(&made_of); material && material->unlit)
        return false;
    return std::visit(
        [](const auto& value) {
            if constexpr (requires { value.emission; }) return value.emission != glm::vec3(0.0f);
            return false;
        },
        made_of);
}

bool has_volume(const glm::dmat4& matrix) {
    const glm::dmat3 linear(matrix);
    const double lengths = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
    const double volume = std::abs(glm::determinant(linear));
    const bool far = !(glm::length(glm::dvec3(matrix[3])) < 1e18) || !(lengths < 1e36);
    return !far && lengths > 1e-36 && volume > 1e-12 * lengths;
}

bool make_rigid(glm::dmat4& matrix) {
    const glm::dvec3 up(matrix[1]), back(matrix[2]), place(matrix[3]);
    const glm::dvec3 right = glm::cross(up, back);
    const double size = glm::length(back) * glm::length(up);
    if (!(size > 0.0) || !std::isfinite(size) || !(glm::length(right) > 1e-9 * size) ||
        !(glm::length(place) < 1e18)) {
        return false;
    }
    const glm::dvec3 z = glm::normalize(back), x = glm::normalize(right);
    matrix = glm::dmat4(glm::dvec4(x, 0.0), glm::dvec4(glm::cross(z, x), 0.0), glm::dvec4(z, 0.0),
                        glm::dvec4(place, 1.0));
    return true;
}

Survey survey(SceneBuilder& builder) {
    return Walk(builder).run();
}

}  // namespace tessera::import
