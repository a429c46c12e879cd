#pragma once

#include <glm/mat4x4.hpp>
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
    glm::dmat4 world_from_camera{1.0};  // rigid: scale and shear of its transforms are taken out
    double vertical_fov = 0.7, aspect_ratio = 0.0;
};

// In the order of the graph. A view takes their values, since nodes know no cameras.
std::vector<PlacedCamera> placed_cameras(const scene::Scene& scene);

CameraPose pose(const PlacedCamera& camera, std::uint32_t width, std::uint32_t height);

// By name, else by its number in the list from 0; "" = the first. The failure names those that there are.
Expected<PlacedCamera> choose_camera(const scene::Scene& scene, const std::string& choice);

}  // namespace tessera::view
