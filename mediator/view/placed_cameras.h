#pragma once

#include <glm/mat4x4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/scene/scene.h"
#include "mediator/view/view.h"

namespace tessera::view {

// A Camera object as it stands in a scene; where it is placed several times, the first time.
struct PlacedCamera {
    ObjectId id;
    std::string name;
    glm::dmat4 world_from_camera{1.0};  // rigid: scale and shear of its transforms are taken out; no numbers
                                        // where they leave it no direction
    scene::Camera values;
    std::vector<glm::dmat4> motion;  // world_from_camera at steps of time, as scene::Transform::motion
};

// In the order of the graph, depth first. A view takes their values, since nodes know no cameras. Each
// transform is walked once, where it is placed first, without recursion: time and memory are in proportion
// to the scene, however deep its graph is and however much it shares.
std::vector<PlacedCamera> placed_cameras(const scene::Scene& scene);

CameraPose pose(const PlacedCamera& camera, std::uint32_t width, std::uint32_t height);

// By name, else by its number in the list from 0; "" = the first. The failure names those that there are. A
// camera without a direction, or 1e15 m away, fails as well.
Expected<PlacedCamera> choose_camera(const scene::Scene& scene, const std::string& choice);

// A chosen camera, followed from version to version. The graph is walked again only for changes that can make
// it another camera; one that moves costs its own transforms.
class FollowedCamera {
  public:
    // As choose_camera has it.
    FollowedCamera(const scene::Scene& scene, std::string choice);

    // `changes` led to `scene`. True: it is somewhere else, there again or gone.
    bool follow(const scene::ChangeList& changes, const scene::Scene& scene);

    // The failure says why there is none.
    const Expected<glm::dmat4>& world_from_camera() const { return world_from_camera_; }

  private:
    Expected<glm::dmat4> choose(const scene::Scene& scene);

    std::string choice_, name_;
    std::optional<std::vector<ObjectId>> path_;  // transforms above it, from the root down
    Expected<glm::dmat4> world_from_camera_;
};

}  // namespace tessera::view
