#include "mediator/view/placed_cameras.h"

#include <glm/geometric.hpp>
#include <set>

namespace tessera::view {

namespace {

// Gram-Schmidt on the viewing direction first, so that what is looked at stays in the middle.
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

struct Walk {
    const scene::Scene& scene;
    std::vector<PlacedCamera> found;
    std::set<ObjectId> seen;

    void visit(ObjectId id, const glm::dmat4& world) {
        const scene::Object* object = scene.find(id);
        if (object == nullptr) return;
        if (const auto* transform = std::get_if<scene::Transform>(object)) {
            for (const ObjectId child : transform->children) visit(child, world * transform->matrix);
        } else if (const auto* camera = std::get_if<scene::Camera>(object);
                   camera && seen.insert(id).second) {
            found.push_back({id, camera->name, rigid(world), camera->vertical_fov, camera->aspect_ratio});
        }
    }
};

}  // namespace

std::vector<PlacedCamera> placed_cameras(const scene::Scene& scene) {
    Walk walk{scene, {}, {}};
    if (const auto* root = scene.find_as<scene::Root>(scene::RootId)) {
        for (const ObjectId child : root->children) walk.visit(child, glm::dmat4(1.0));
    }
    return std::move(walk.found);
}

CameraPose pose(const PlacedCamera& camera, std::uint32_t width, std::uint32_t height) {
    return perspective(camera.world_from_camera, camera.vertical_fov, double(width) / double(height));
}

Expected<PlacedCamera> choose_camera(const scene::Scene& scene, const std::string& choice) {
    const std::vector<PlacedCamera> cameras = placed_cameras(scene);
    if (cameras.empty()) return failure(ErrorCode::NotFound, "the scene has no camera: load or create one");
    if (choice.empty()) return cameras.front();
    std::string list;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        if (cameras[i].name == choice || std::to_string(i) == choice) return cameras[i];
        list += (list.empty() ? "" : ", ") + std::to_string(i) + " '" + cameras[i].name + "'";
    }
    return failure(ErrorCode::NotFound, "the scene has no camera '" + choice + "'; it has: " + list);
}

}  // namespace tessera::view
