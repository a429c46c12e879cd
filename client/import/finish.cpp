#include "client/import/finish.h"

#include <algorithm>

#include "client/import/environment.h"
#include "client/import/framing.h"
#include "client/import/soft_sky.h"
#include "client/import/survey.h"

namespace tessera::import {
namespace {

// What was told of the file until nothing of it was left, in brackets.
std::string causes(const std::vector<std::string>& notices) {
    constexpr std::size_t Most = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(notices.size(), Most); ++i)
        text += (i == 0 ? " (" : "; ") + notices[i];
    return text.empty() ? text : text + (notices.size() > Most ? "; and others)" : ")");
}

}  // namespace

void add_framing_camera(SceneBuilder& builder, const Bounds& bounds) {
    scene::Camera camera;
    camera.name = "framing";
    scene::Transform transform;
    transform.name = "framing camera";
    transform.matrix = framing_pose(bounds, camera.vertical_fov, builder.options().aspect_ratio);
    const ObjectId id = builder.add(std::move(camera));
    const auto& added = builder.get<scene::Camera>(id);
    transform.children = {id};
    builder.result().cameras.push_back({added.name, transform.matrix, added});
    builder.result().root.children.push_back(builder.add(std::move(transform)));
    builder.notice("no camera: one that frames everything was added");
}

void finish(SceneBuilder& builder, scene::Background of_file) {
    Survey found = survey(builder);
    ImportedScene& result = builder.result();
    const ImportOptions& options = builder.options();
    if (result.counts.instances == 0) {
        throw Error(ErrorCode::InvalidInput, "it places no triangles" + causes(result.notices) +
                                                 ": there is nothing to draw, export meshes in its scene");
    }
    result.cameras = std::move(found.cameras);
    const bool may_add = options.missing == Missing::Add;
    if (result.cameras.empty() && may_add) add_framing_camera(builder, found.bounds);

    scene::Background background = std::move(of_file);
    if (background.name.empty()) background.name = "background";
    background.color = options.background.value_or(background.color);
    if (!options.environment.empty()) {
        background.environment = add_environment(options.environment, builder);
        background.strength = options.environment_strength;
    }
    const bool shines = result.counts.lights > 0 || background.color != glm::vec3(0.0f) ||
                        background.environment || options.background;
    if (may_add && !shines && !found.glow.lights(found.bounds)) {
        background.environment = add_soft_sky(builder);
        builder.notice(result.counts.emissive_geometries == 0
                           ? "no light: a soft sky was added"
                           : "no light but what glows faintly: a soft sky was added; a black background "
                             "leaves it out (--background 0,0,0)");
    }
    result.root.background = builder.add(std::move(background));
    result.root.name = "root";
}

}  // namespace tessera::import
