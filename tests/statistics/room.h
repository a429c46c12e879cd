#pragma once

#include "tests/statistics/scene_model.h"

namespace tessera::test {

// A chalk room of 4 x 4 x 3 m; in the wall at +x a window of 1 m2, unless it is closed.
inline void add_room(SceneModel& model, bool has_window = true) {
    const ObjectId chalked = model.material(chalk(glm::vec3(0.6f)));
    model.floor(chalked, 2.0f, 0.0f);
    model.floor(chalked, -2.0f, 3.0f);
    model.quad(chalked, {{{-2, -2, 0}, {-2, 2, 0}, {-2, 2, 3}, {-2, -2, 3}}});
    model.quad(chalked, {{{-2, -2, 0}, {-2, -2, 3}, {2, -2, 3}, {2, -2, 0}}});
    model.quad(chalked, {{{-2, 2, 0}, {2, 2, 0}, {2, 2, 3}, {-2, 2, 3}}});
    const auto wall = [&](float y0, float y1, float z0, float z1) {
        model.quad(chalked, {{{2, y0, z0}, {2, y0, z1}, {2, y1, z1}, {2, y1, z0}}});
    };
    wall(-2, 2, 0, 1);
    wall(-2, 2, 2, 3);
    wall(-2, -0.5f, 1, 2);
    wall(0.5f, 2, 1, 2);
    if (!has_window) wall(-0.5f, 0.5f, 1, 2);
}

// A map of luminance 0.5 with one texel of `sun`, which shines through the window.
inline void add_sky_with_sun(SceneModel& model, float sun) {
    std::vector<glm::vec3> texels(32 * 16, glm::vec3(0.5f));
    texels[5 * 32 + 24] = glm::vec3(sun);
    scene::Background background{.strength = 1.0f};
    background.environment =
        model.texture({.width = 32, .height = 16, .format = scene::TexelFormat::RgbFloat}, texels).texture;
    model.sky(background);
}

// From beneath the window towards the back wall and the floor of a room of this scale at this place.
inline view::View inside_room(double scale = 1.0, const glm::dvec3& origin = glm::dvec3(0.0)) {
    const glm::dmat4 turn =
        glm::inverse(glm::lookAt(glm::dvec3(0.0), glm::dvec3(-1.0, 0.2, -0.4), glm::dvec3(0.0, 0.0, 1.0)));
    return small_view(origin + scale * glm::dvec3(1.5, 0.0, 1.8), 60.0, 16, turn);
}

}  // namespace tessera::test
