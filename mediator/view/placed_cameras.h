#pragma once

#include <glm/mat4x4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/scene/scene.h"
#include "mediator/view/view.h"

namespace tessera::view {

// A Camera object with its transform in the scene; the first one if it is instanced.
struct PlacedCamera {
    ObjectId id;
    std::string name;
    glm::dmat4 world_from_camera{1.0};  // rigid: without scale and shear of its transforms; NaN if they
                                        // are singular
    scene::Camera values;
    std::vector<glm::dmat4> motion;  // motion keys of world_from_camera, as scene::Transform::motion
};

// In the order of the graph, depth first. Each transform is visited once, without recursion: time and memory are
// proportional to the scene, for any depth and amount of sharing.
std::vector<PlacedCamera> placed_cameras(const scene::Scene& scene);

CameraPose pose(const PlacedCamera& camera, std::uint32_t width, std::uint32_t height);

// By name, else by its index in the list, from 0; "" = the first. The failure lists the cameras. A camera with a
// singular transform, or beyond 1e15 m, fails as well.
Expected<PlacedCamera> choose_camera(const scene::Scene& scene, const std::string& choice);

// A chosen camera, tracked from version to version. The graph is searched again only after changes that may select
// another camera; if only its transforms change, the cost is theirs.
class FollowedCamera {
  public:
    // `choice` as for choose_camera.
    FollowedCamera(const scene::Scene& scene, std::string choice);

    // `scene` is the state after `changes`. True: the camera moved, appeared or disappeared.
    bool follow(const scene::ChangeList& changes, const scene::Scene& scene);

    // The failure says why there is no camera.
    const Expected<glm::dmat4>& world_from_camera() const { return world_from_camera_; }

  private:
    Expected<glm::dmat4> choose(const scene::Scene& scene);

    std::string choice_, name_;
    std::optional<std::vector<ObjectId>> path_;  // the transforms above it, from the root down
    Expected<glm::dmat4> world_from_camera_;
};

}  // namespace tessera::view
