#include "mediator/view/placed_cameras.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <unordered_map>

#include "mediator/scene/fields.h"
#include "mediator/scene/motion.h"

namespace tessera::view {

namespace {

using namespace scene;

// Limit of the translation of a transform.
constexpr double MaxCoordinate = 1e15;

// Gram-Schmidt, starting with the view direction, so that the image center stays the same.
glm::dmat4 rigid(const glm::dmat4& matrix) {
    const glm::dvec3 z = glm::normalize(glm::dvec3(matrix[2]));
    const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(matrix[1]), z));
    glm::dmat4 result(1.0);
    result[0] = glm::dvec4(x, 0.0);
    result[1] = glm::dvec4(glm::cross(z, x), 0.0);
    result[2] = glm::dvec4(z, 0.0);
    result[3] = matrix[3];
    return result;
}

// Products of valid matrices may still be singular or overflow.
Expected<glm::dmat4> checked(const glm::dmat4& world_from_camera, const std::string& name) {
    for (glm::length_t column = 0; column < 4; ++column) {
        // Also false for NaN.
        const glm::dvec3 size = glm::abs(glm::dvec3(world_from_camera[column]));
        if (!glm::all(glm::lessThan(size, glm::dvec3(MaxCoordinate))))
            return failure(
                ErrorCode::InvalidInput,
                "camera '" + name +
                    "' has no valid direction: the transforms above it are singular or too large; fix them");
    }
    return world_from_camera;
}

class CameraTraversal {
  public:
    explicit CameraTraversal(const Scene& scene) : scene_(scene) {
        if (const auto* root = scene.find_as<Root>(RootId)) open_.push_back({RootId, &root->children});
        while (!open_.empty()) {
            Step& step = open_.back();
            if (step.next == step.children->size()) {
                open_.pop_back();
            } else {
                const ObjectId child = (*step.children)[step.next++];
                if (const Object* object = scene.find(child)) visit(child, *object, step);
            }
        }
    }

    // The transforms above an object, from the root down.
    std::vector<ObjectId> path(ObjectId id) const {
        std::vector<ObjectId> path;
        while ((id = above_.at(id)) != RootId) path.push_back(id);
        std::reverse(path.begin(), path.end());
        return path;
    }

    std::vector<PlacedCamera> cameras;

  private:
    struct Step {
        ObjectId id;
        const std::vector<ObjectId>* children;
        glm::dmat4 world{1.0};
        std::size_t next = 0;
    };

    void visit(ObjectId id, const Object& object, const Step& parent) {
        const auto* transform = std::get_if<Transform>(&object);
        const auto* camera = std::get_if<Camera>(&object);
        if (transform == nullptr && camera == nullptr) return;
        // Its subtree has been visited already.
        if (!above_.emplace(id, parent.id).second) return;
        if (transform != nullptr) {
            open_.push_back({id, &transform->children, parent.world * transform->matrix});
        } else {
            cameras.push_back({id, camera->name, rigid(parent.world), *camera, {}});
            for (const glm::dmat4& step : motion_along(scene_, path(id))) {
                cameras.back().motion.push_back(rigid(step));
            }
        }
    }

    const Scene& scene_;
    std::vector<Step> open_;
    std::unordered_map<ObjectId, ObjectId> above_;  // the first parent of each transform and camera
};

Expected<PlacedCamera> chosen(const std::vector<PlacedCamera>& cameras, const std::string& choice) {
    if (cameras.empty()) return failure(ErrorCode::NotFound, "the scene has no camera: load or create one");
    if (choice.empty()) return cameras.front();
    std::string list;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        if (cameras[i].name == choice || std::to_string(i) == choice) return cameras[i];
        list += (list.empty() ? "" : ", ") + std::to_string(i) + " '" + cameras[i].name + "'";
    }
    return failure(ErrorCode::NotFound, "the scene has no camera '" + choice + "'; it has: " + list);
}

enum class Concern { None, Matrix, Graph };

Concern concern(const Entry& entry) {
    if (const auto* create = std::get_if<Create>(&entry)) {
        const bool can_place = std::holds_alternative<Root>(create->object) ||
                               std::holds_alternative<Transform>(create->object) ||
                               std::holds_alternative<Camera>(create->object);
        return can_place ? Concern::Graph : Concern::None;
    }
    const auto* update = std::get_if<Update>(&entry);
    if (update == nullptr) return Concern::Graph;
    if (std::holds_alternative<Root>(update->fields)) {
        const auto fields = Fields<Root>::from_bits(update->mask);
        return fields.contains(&Root::children) ? Concern::Graph : Concern::None;
    }
    if (std::holds_alternative<Transform>(update->fields)) {
        const auto fields = Fields<Transform>::from_bits(update->mask);
        if (fields.contains(&Transform::children)) return Concern::Graph;
        return fields.contains(&Transform::matrix) ? Concern::Matrix : Concern::None;
    }
    if (std::holds_alternative<Camera>(update->fields)) {
        const auto fields = Fields<Camera>::from_bits(update->mask);
        return fields.contains(&Camera::name) ? Concern::Graph : Concern::None;
    }
    return Concern::None;
}

}  // namespace

std::vector<PlacedCamera> placed_cameras(const Scene& scene) {
    return std::move(CameraTraversal(scene).cameras);
}

CameraPose pose(const PlacedCamera& camera, std::uint32_t width, std::uint32_t height) {
    CameraPose pose = view::pose(camera.values, camera.world_from_camera, double(width) / double(height));
    pose.motion = camera.motion;
    return pose;
}

Expected<PlacedCamera> choose_camera(const Scene& scene, const std::string& choice) {
    auto camera = chosen(placed_cameras(scene), choice);
    if (!camera) return camera;
    if (const auto world = checked(camera->world_from_camera, camera->name); !world)
        return tl::unexpected(world.error());
    for (const glm::dmat4& step : camera->motion) {
        if (const auto world = checked(step, camera->name); !world) return tl::unexpected(world.error());
    }
    return camera;
}

FollowedCamera::FollowedCamera(const Scene& scene, std::string choice)
    : choice_(std::move(choice)), world_from_camera_(choose(scene)) {}

Expected<glm::dmat4> FollowedCamera::choose(const Scene& scene) {
    const CameraTraversal traversal(scene);
    const auto camera = chosen(traversal.cameras, choice_);
    path_.reset();
    if (!camera) return tl::unexpected(camera.error());
    name_ = camera->name;
    path_ = traversal.path(camera->id);
    return checked(camera->world_from_camera, name_);
}

bool FollowedCamera::follow(const ChangeList& changes, const Scene& scene) {
    auto strongest = changes.is_snapshot() ? Concern::Graph : Concern::None;
    for (const Entry& entry : changes.entries) strongest = std::max(strongest, concern(entry));
    Expected<glm::dmat4> now = world_from_camera_;
    if (strongest == Concern::Graph) {
        now = choose(scene);
    } else if (strongest == Concern::Matrix && path_) {
        glm::dmat4 world(1.0);
        for (const ObjectId id : *path_) world = world * scene.find_as<Transform>(id)->matrix;
        now = checked(rigid(world), name_);
    }
    const bool is_same = now.has_value() == world_from_camera_.has_value() &&
                         (!now.has_value() || *now == *world_from_camera_);
    world_from_camera_ = std::move(now);
    return !is_same;
}

}  // namespace tessera::view
