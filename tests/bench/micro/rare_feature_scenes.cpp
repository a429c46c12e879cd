#include "tests/bench/micro/rare_feature_scenes.h"

#include "tests/bench/micro/exact_kernels.h"

namespace tessera::embree {
namespace {

const scene::Material Blue{.base_color = {0.3f, 0.5f, 0.8f, 1.0f}, .roughness = 0.5f};
const glm::dvec3 Center(0.0, -0.4, 0.9);

// Features of most scenes: textured boards, plastic, rough metal, a mirror, clear glass, a lamp and a sky.
void add_room(Model& model) {
    scene::Material boards = chalk(glm::vec3(1.0f));
    std::vector<std::uint8_t> texels;
    for (std::uint32_t i = 0; i < 64; ++i)
        texels.insert(texels.end(), 4, (i + i / 8) % 2 == 0 ? std::uint8_t{220} : std::uint8_t{120});
    boards.base_color_texture = model.texture({.width = 8, .height = 8}, texels);
    const ObjectId walls = model.material(boards);
    model.textured_quad(walls, {{{-3, -1, 3}, {3, -1, 3}, {3, -1, -3}, {-3, -1, -3}}}, 4.0f);
    model.textured_quad(walls, {{{-3, -1, -3}, {3, -1, -3}, {3, 3, -3}, {-3, 3, -3}}}, 4.0f);
    model.quad(model.material(lamp(8.0f)), {{{-1, 2.9f, -1}, {1, 2.9f, -1}, {1, 2.9f, 1}, {-1, 2.9f, 1}}});
    model.sphere(model.material({.base_color = {0.7f, 0.3f, 0.2f, 1.0f}, .roughness = 0.4f}),
                 {-1.2, -0.5, 0.6}, 0.5, Normals::Smooth);
    model.sphere(
        model.material({.base_color = {0.9f, 0.8f, 0.5f, 1.0f}, .metallic = 1.0f, .roughness = 0.3f}),
        {1.2, -0.5, 0.6}, 0.5, Normals::Smooth);
    model.sphere(model.material(mirror(glm::vec3(0.9f))), {1.0, 0.0, -1.5}, 0.8, Normals::Smooth);
    model.sphere(model.material(glass(1.5f)), {-1.0, 0.0, -1.5}, 0.8, Normals::Smooth);
    model.sky(glm::vec3(0.4f, 0.5f, 0.6f));
}

void add_ball(Model& model, const scene::Material& material) {
    add_room(model);
    model.sphere(model.material(material), Center, 0.6, Normals::Smooth);
}

void add_none(Model& model) {
    add_ball(model, Blue);
}

void add_coat(Model& model) {
    scene::Material paint = Blue;
    paint.clearcoat = 1.0f;
    paint.clearcoat_roughness = 0.1f;
    add_ball(model, paint);
}

void add_sheen(Model& model) {
    scene::Material cloth = Blue;
    cloth.sheen_color = glm::vec3(0.6f);
    cloth.sheen_roughness = 0.4f;
    add_ball(model, cloth);
}

void add_anisotropy(Model& model) {
    add_none(model);
    const scene::Material brushed{
        .base_color = {0.9f, 0.5f, 0.3f, 1.0f}, .metallic = 1.0f, .roughness = 0.3f, .anisotropy = 0.7f};
    model.textured_quad(
        model.material(brushed),
        {{{-0.8f, -0.5f, 1.2f}, {0.8f, -0.5f, 1.2f}, {0.8f, 0.5f, 1.0f}, {-0.8f, 0.5f, 1.0f}}}, 1.0f);
}

void add_rough_glass(Model& model) {
    scene::Material frosted = glass(1.5f);
    frosted.roughness = 0.3f;
    add_ball(model, frosted);
}

void add_thin_glass(Model& model) {
    scene::Material pane = glass(1.5f);
    pane.thickness = 0.0f;
    add_ball(model, pane);
}

void add_film(Model& model) {
    scene::Material oil = Blue;
    oil.iridescence = 1.0f;
    add_ball(model, oil);
}

void add_attenuation(Model& model) {
    scene::Material bottle = glass(1.5f);
    bottle.attenuation_color = glm::vec3(0.5f, 0.9f, 0.7f);
    bottle.attenuation_distance = 0.5f;
    add_ball(model, bottle);
}

void add_fog(Model& model) {
    add_none(model);
    model.set_medium({.absorption = glm::vec3(0.02f), .scattering = glm::vec3(0.1f)});
    model.box(ObjectId{}, {-2.9f, -0.95f, -2.9f}, {2.9f, 2.0f, 2.9f});
}

void add_motion(Model& model) {
    add_room(model);
    model.moves({glm::translate(glm::dmat4(1.0), {0.2, 0.0, 0.0})});
    model.sphere(model.material(Blue), Center, 0.6, Normals::Smooth);
}

void add_shader(Model& model) {
    add_room(model);
    model.sphere(model.shader({.specular = glm::vec3(0.3f)}), Center, 0.6, Normals::Smooth);
}

void add_catcher(Model& model) {
    add_none(model);
    model.floor(model.material({.shadow_catcher = true}), 0.8f, 1.2f);
}

void add_area_lights(Model& model) {
    add_none(model);
    model.light({.kind = scene::LightKind::Sphere, .intensity = glm::vec3(4.0f), .radius = 0.2f},
                glm::translate(glm::dmat4(1.0), {-1.5, 1.5, 1.0}));
    model.light({.kind = scene::LightKind::Quad, .intensity = glm::vec3(4.0f)},
                glm::translate(glm::dmat4(1.0), {1.5, 1.5, 1.0}));
}

}  // namespace

const std::vector<RareFeatureScene>& rare_feature_scenes() {
    static const std::vector<RareFeatureScene> scenes{{"none", add_none, &exact::none},
                                                      {"coat", add_coat, &exact::coat},
                                                      {"sheen", add_sheen, &exact::sheen},
                                                      {"anisotropy", add_anisotropy, &exact::anisotropy},
                                                      {"rough_glass", add_rough_glass, &exact::rough_glass},
                                                      {"thin_glass", add_thin_glass, &exact::thin_glass},
                                                      {"film", add_film, &exact::film},
                                                      {"attenuation", add_attenuation, &exact::attenuation},
                                                      {"fog", add_fog, &exact::fog},
                                                      {"motion", add_motion, &exact::motion},
                                                      {"shader", add_shader, &exact::shader},
                                                      {"catcher", add_catcher, &exact::catcher},
                                                      {"area_lights", add_area_lights, &exact::area_lights}};
    return scenes;
}

}  // namespace tessera::embree
