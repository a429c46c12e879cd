#include "tests/export/rich_scene.h"

#include <gtest/gtest.h>

#include <glm/ext/matrix_transform.hpp>

#include "mediator/scene/validate.h"

namespace tessera::exporting {
namespace {

class Maker {
  public:
    explicit Maker(RichScene& to) : to_(to) {}

    ObjectId add(scene::Object object) {
        const ObjectId id{2 + entries_.size()};
        entries_.push_back(scene::Create{id, std::move(object)});
        return id;
    }
    template <class T>
    scene::BlobRef blob(const std::vector<T>& values) {
        return scene::reference(*to_.blobs.insert(std::as_bytes(std::span(values))));
    }
    void finish(scene::Root root) {
        entries_.push_back(scene::Create{scene::RootId, std::move(root)});
        const auto applied = to_.scene.apply_entries(entries_);
        ASSERT_TRUE(applied) << applied.error().what();
        to_.scene.set_version({77, 12});
        for (const scene::Problem& problem : scene::validate(to_.scene)) ADD_FAILURE() << problem.message;
    }

  private:
    RichScene& to_;
    std::vector<scene::Entry> entries_;
};

scene::Geometry square(Maker& maker, float size, ObjectId material) {
    scene::Geometry square;
    square.name = "square";
    square.material = material;
    square.indices = maker.blob<std::uint32_t>({0, 1, 2, 2, 1, 3});
    square.positions = maker.blob<glm::vec3>({{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {size, size, 0.1f}});
    square.normals = maker.blob(std::vector<glm::vec3>(4, {0, 0, 1}));
    square.tangents = maker.blob(std::vector<glm::vec4>(4, {1, 0, 0, -1}));
    square.tex_coords = maker.blob<glm::vec2>({{0, 1}, {1, 1}, {0, 0}, {1, 0}});
    square.tex_coords_1 = maker.blob<glm::vec2>({{0, 2}, {2, 2}, {0, 0}, {2, 0}});
    square.colors =
        maker.blob<glm::vec4>({{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {0.2f, 0.3f, 0.4f, 0.5f}});
    return square;
}

scene::Material colorful(ObjectId picture, ObjectId data) {
    scene::Material material;
    material.name = "my \"red\"";
    material.base_color = {0.9f, 0.1f, 0.05f, 0.75f};
    material.base_color_texture = {picture, {0.25f, 0.5f}, {2.0f, 3.0f}, 0.7f};
    material.metallic = 0.3f;
    material.roughness = 0.4f;
    material.metallic_roughness_texture = {.texture = data};
    material.normal_texture = {.texture = data};
    material.normal_scale = 0.8f;
    material.emission = {17.3f, 0.7f, 3.1f};
    material.emission_texture = {.texture = picture};
    material.alpha_mode = scene::AlphaMode::Mask;
    material.alpha_cutoff = 0.35f;
    material.double_sided = true;
    material.unlit = true;
    material.index_of_refraction = 1.33f;
    material.transmission = 0.6f;
    material.transmission_texture = {.texture = data, .set = 1};
    material.thickness = 0.25f;
    material.attenuation_color = {0.5f, 0.75f, 1.0f};
    material.attenuation_distance = 2.5f;
    material.specular = 0.7f;
    material.specular_texture = {.texture = data, .rotation = 0.3f};
    material.specular_color = {1.5f, 0.5f, 0.25f};
    material.specular_color_texture = {.texture = picture};
    material.clearcoat = 0.9f;
    material.clearcoat_texture = {.texture = data};
    material.clearcoat_roughness = 0.2f;
    material.clearcoat_roughness_texture = {.texture = data, .set = 1};
    material.clearcoat_normal_texture = {.texture = data, .offset = {0.5f, 0.25f}};
    material.clearcoat_normal_scale = 0.6f;
    material.sheen_color = {0.3f, 0.2f, 0.1f};
    material.sheen_color_texture = {.texture = picture};
    material.sheen_roughness = 0.45f;
    material.sheen_roughness_texture = {.texture = data};
    material.anisotropy = 0.55f;
    material.anisotropy_rotation = 1.2f;
    material.anisotropy_texture = {.texture = data};
    material.iridescence = 0.35f;
    material.iridescence_texture = {.texture = data};
    material.iridescence_index_of_refraction = 1.8f;
    material.iridescence_thickness_minimum = 50.0f;
    material.iridescence_thickness_maximum = 700.0f;
    material.iridescence_thickness_texture = {.texture = data};
    material.shadow_catcher = true;
    return material;
}

}  // namespace

void make_rich(RichScene& to) {
    Maker maker(to);
    std::vector<std::uint8_t> texels;
    for (int i = 0; i < 3 * 2 * 4; ++i) texels.push_back(static_cast<std::uint8_t>(i * 37));
    scene::Texture picture{.name = "wood", .width = 3, .height = 2, .format = scene::TexelFormat::Rgba8Srgb};
    picture.wrap_s = scene::Wrap::Mirror;
    picture.wrap_t = scene::Wrap::Clamp;
    picture.filter = scene::TextureFilter::Nearest;
    picture.texels = maker.blob(texels);
    scene::Texture data = picture;
    data.name = "data";
    data.format = scene::TexelFormat::Rgba8;
    data.filter = scene::TextureFilter::Linear;
    scene::Texture sky{.name = "sky", .width = 2, .height = 1, .format = scene::TexelFormat::RgbFloat};
    sky.texels = maker.blob<float>({1, 2, 3, 4e3f, 0.5f, 0});
    const ObjectId picture_id = maker.add(picture), data_id = maker.add(data), sky_id = maker.add(sky);

    const ObjectId red = maker.add(colorful(picture_id, data_id));
    scene::Geometry deformed = square(maker, 1.0f, red);
    for (const float lift : {0.5f, 0.75f}) {
        deformed.motion_positions.push_back(
            maker.blob<glm::vec3>({{0, 0, lift}, {1, 0, 0}, {0, 1, 0}, {1, 1, lift}}));
        deformed.motion_normals.push_back(maker.blob(std::vector<glm::vec3>(4, {lift, 0, 1})));
    }
    const ObjectId one = maker.add(deformed);
    scene::Geometry other = square(maker, 2.5f, ObjectId{});
    other.name = "square part 1";
    other.normals = other.tangents = other.tex_coords = other.tex_coords_1 = other.colors = {};
    const ObjectId two = maker.add(other);

    const ObjectId point = maker.add(scene::Light{.name = "bulb", .intensity = {3.0f, 2.0f, 0.1f}});
    const ObjectId spot = maker.add(scene::Light{.name = "spot",
                                                 .kind = scene::LightKind::Spot,
                                                 .intensity = {100.0f, 90.0f, 80.0f},
                                                 .inner_cone_angle = 0.2f,
                                                 .outer_cone_angle = 0.5f});
    const ObjectId sun = maker.add(
        scene::Light{.name = "sun", .kind = scene::LightKind::Directional, .intensity = {0.0f, 0.0f, 0.0f}});
    const ObjectId camera =
        maker.add(scene::Camera{.name = "front", .vertical_fov = 0.123456789, .aspect_ratio = 1.5});
    const ObjectId tag = maker.add(scene::Attachment{.name = "tag", .key = "owner", .value = "a\nb\xff"});

    scene::Transform wheel{.name = "wheel", .children = {one, two, tag}};
    wheel.matrix = glm::rotate(glm::translate(glm::dmat4(1.0), {0.1, 1.0 / 3.0, -2e5}), 0.3, {1.0, 2.0, 0.5});
    wheel.hint = scene::MotionHint::Animated;
    wheel.layers = 0x80000006;
    wheel.motion = {glm::rotate(wheel.matrix, 0.1, {0.0, 0.0, 1.0}), glm::dmat4(1.0)};
    const ObjectId wheel_id = maker.add(wheel);
    scene::Transform left{.name = "left", .children = {wheel_id, point}};
    left.matrix = glm::scale(glm::dmat4(1.0), {1.0, -2.0, 3.0});
    scene::Transform right{.name = "", .children = {wheel_id, spot, camera, sun}};
    const ObjectId left_id = maker.add(left), right_id = maker.add(right);
    const ObjectId background = maker.add(
        scene::Background{.name = "evening", .environment = sky_id, .strength = 0.5f, .rotation = 1.0f});
    maker.finish({.name = "top",
                  .children = {left_id, right_id, one},
                  .background = background,
                  .render_origin = {1024.0, 0.0, 0.0}});
}

}  // namespace tessera::exporting
