#include "client/import/post_process.h"

#include <algorithm>
#include <glm/common.hpp>

#include "client/import/default_environment.h"
#include "client/import/environment.h"
#include "client/import/framing.h"
#include "client/import/lights_as_sky.h"
#include "client/import/scene_stats.h"
#include "mediator/scene/field_notes.h"

namespace tessera::import {
namespace {

// The first notices about the file in brackets, as the cause of an error.
std::string causes(const std::vector<std::string>& notices) {
    constexpr std::size_t Most = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(notices.size(), Most); ++i)
        text += (i == 0 ? " (" : "; ") + notices[i];
    return text.empty() ? text : text + (notices.size() > Most ? "; and others)" : ")");
}

}  // namespace

void add_framing_camera(SceneBuilder& builder, const Bounds& bounds) {
    // So that the camera is not beyond what a scene may have: it is some times as far away as the scene extends, more
    // only for pictures that are hundreds of times as high as wide.
    constexpr double MaxVisible = scene::MaxCoordinate / 1000.0;
    Bounds visible = bounds;
    if (!bounds.empty()) {
        visible = {glm::clamp(bounds.lower, -MaxVisible, MaxVisible),
                   glm::clamp(bounds.upper, -MaxVisible, MaxVisible)};
    }
    const bool is_whole = visible.lower == bounds.lower && visible.upper == bounds.upper;
    scene::Camera camera;
    camera.name = "framing";
    scene::Transform transform;
    transform.name = "framing camera";
    transform.matrix = framing_pose(visible, camera.vertical_fov, builder.options().aspect_ratio);
    const ObjectId id = builder.add(std::move(camera));
    const auto& added = builder.get<scene::Camera>(id);
    transform.children = {id};
    builder.result().cameras.push_back({added.name, transform.matrix, added});
    builder.result().root.children.push_back(builder.add(std::move(transform)));
    builder.notice(is_whole ? "no camera: added one that frames the scene"
                            : "no camera: added one that frames what is within 1e12 m of the origin");
}

void post_process(SceneBuilder& builder, scene::Background of_file) {
    SceneStats stats = gather_scene_stats(builder);
    ImportedScene& result = builder.result();
    const ImportOptions& options = builder.options();
    if (result.counts.instances == 0) {
        throw Error(ErrorCode::InvalidInput, "it contains no triangles" + causes(result.notices) +
                                                 ": there is nothing to render, export meshes in its scene");
    }
    result.cameras = std::move(stats.cameras);
    const bool may_add = options.missing == Missing::Add;
    if (result.cameras.empty() && may_add) add_framing_camera(builder, stats.bounds);

    scene::Background background = std::move(of_file);
    if (background.name.empty()) background.name = "background";
    background.color = options.background.value_or(background.color);
    if (!options.environment.empty()) {
        background.environment = add_environment(options.environment, builder);
        background.strength = options.environment_strength;
        background.rotation = options.environment_rotation;
    }
    replace_lights_by_sky(builder, stats, background);
    const bool has_light = result.counts.lights > 0 || background.color != glm::vec3(0.0f) ||
                           background.environment || options.background;
    if (may_add && !has_light && !stats.emissive_lights.are_significant(stats.bounds)) {
        background.environment = add_default_environment(builder);
        builder.notice(result.counts.emissive_geometries == 0
                           ? "no light: a default environment (overcast sky) was added"
                           : "only faint emission as light: a default environment (overcast sky) was added; "
                             "--background 0,0,0 turns it off");
    }
    result.root.background = builder.add(std::move(background));
    result.root.name = "root";
}

}  // namespace tessera::import
