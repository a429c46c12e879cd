#include "client/edit/path_index.h"
#include "client/edit/script_error.h"
#include "client/edit/values.h"
#include "mediator/scene/fields.h"
#include "tests/edit/fake_target.h"

namespace tessera::edit {
namespace {

using scene::ObjectKind;
using testing::HasSubstr;

// For every field: a non-default value as typed, as printed, and an invalid one. Blobs cannot be typed.
struct FieldCase {
    std::string typed, shown, wrong;
};

const FieldCase Name{"\"two words\"", "\"two words\"", "two words"};
const FieldCase Hint{"animated", "animated", "fast"};
const FieldCase Children{"transforms/wheel lights/bulb", "transforms/wheel lights/bulb", "transforms/weel"};
const FieldCase Slot{"textures/data offset=1,-2 rotation=0.5 set=1",
                     "textures/data offset=1,-2 scale=1,1 rotation=0.5 set=1", "textures/data offset=1"};
const FieldCase Number{"0.25", "0.25", "0.25x"}, Whole{"7", "7", "-7"}, Truth{"yes", "true", "maybe"};
const FieldCase Color{"0.5,0.25 1e-3", "0.5 0.25 0.001", "0.5 0.25"};
const FieldCase Pair{"0.5,0.25", "0.5 0.25", "0.5 x"}, SignedWhole{"-7", "-7", "7.5"};
const FieldCase Wrap{"clamp", "clamp", "Clamp"};
const FieldCase Blob{"", "", "12"};
const std::map<std::string, FieldCase> Cases{
    {"root.children", Children},
    {"root.background", {"none", "none", "5"}},
    {"root.render_origin", {"1 2 1e9", "1 2 1e+09", "1 2"}},
    {"transform.matrix",
     {"1 0 0 0  0 2 0 0  0 0 3 0  4 5 6 1", "1 0 0 0  0 2 0 0  0 0 3 0  4 5 6 1", "1 2 3"}},
    {"transform.children", Children},
    {"transform.hint", Hint},
    {"transform.layers", Whole},
    {"transform.motion",
     {"1 0 0 0  0 2 0 0  0 0 3 0  4 5 6 1 identity", "1 0 0 0  0 2 0 0  0 0 3 0  4 5 6 1   identity",
      "identity 1 2 3"}},
    {"geometry.material", {"materials/\"my \\\"red\\\"\"", "materials/\"my \\\"red\\\"\"", "red"}},
    {"geometry.hint", Hint},
    {"material.base_color", {"0.8 0.1 0.1 0.5", "0.8 0.1 0.1 0.5", "0.8 0.1"}},
    {"material.base_color_texture", Slot},
    {"material.metallic", Number},
    {"material.roughness", Number},
    {"material.metallic_roughness_texture", Slot},
    {"material.normal_texture", Slot},
    {"material.normal_scale", Number},
    {"material.emission", Color},
    {"material.emission_texture", Slot},
    {"material.alpha_mode", {"blend", "blend", "1"}},
    {"material.alpha_cutoff", Number},
    {"material.double_sided", Truth},
    {"material.unlit", Truth},
    {"material.index_of_refraction", Number},
    {"material.transmission", Number},
    {"texture.width", Whole},
    {"texture.height", Whole},
    {"texture.depth", Whole},
    {"texture.format", {"rgb_float", "rgb_float", "rgb"}},
    {"texture.wrap_s", Wrap},
    {"texture.wrap_t", Wrap},
    {"texture.filter", {"nearest", "nearest", "cubic"}},
    {"light.kind", {"spot", "spot", "area"}},
    {"light.intensity", {"5", "5 5 5", "5 6"}},
    {"light.inner_cone_angle", Number},
    {"light.outer_cone_angle", Number},
    {"camera.vertical_fov", {"0.12345678901234567", "0.12345678901234566", "inf"}},
    {"camera.aspect_ratio", Number},
    {"background.color", Color},
    {"background.environment", {"textures/sky", "textures/sky", "sky"}},
    {"background.strength", Number},
    {"background.rotation", {"-1.5", "-1.5", "1e39"}},
    {"attachment.key", {"k", "k", "k k"}},
    {"attachment.value", {"\"a\\n,b\"", "\"a\\n,b\"", "a b"}},
    {"material.transmission_texture", Slot},
    {"material.thickness", Number},
    {"material.attenuation_color", Color},
    {"material.attenuation_distance", Number},
    {"material.specular", Number},
    {"material.specular_texture", Slot},
    {"material.specular_color", Color},
    {"material.specular_color_texture", Slot},
    {"material.clearcoat", Number},
    {"material.clearcoat_texture", Slot},
    {"material.clearcoat_roughness", Number},
    {"material.clearcoat_roughness_texture", Slot},
    {"material.clearcoat_normal_texture", Slot},
    {"material.clearcoat_normal_scale", Number},
    {"material.sheen_color", Color},
    {"material.sheen_color_texture", Slot},
    {"material.sheen_roughness", Number},
    {"material.sheen_roughness_texture", Slot},
    {"material.anisotropy", Number},
    {"material.anisotropy_rotation", Number},
    {"material.anisotropy_texture", Slot},
    {"material.iridescence", Number},
    {"material.iridescence_texture", Slot},
    {"material.iridescence_index_of_refraction", Number},
    {"material.iridescence_thickness_minimum", Number},
    {"material.iridescence_thickness_maximum", Number},
    {"material.iridescence_thickness_texture", Slot},
    {"material.shadow_catcher", Truth},
    {"surface_shader.emission", Color},
    {"surface_shader.emission_texture", Slot},
    {"surface_shader.ambient", Color},
    {"surface_shader.ambient_texture", Slot},
    {"surface_shader.diffuse", Color},
    {"surface_shader.diffuse_texture", Slot},
    {"surface_shader.specular", Color},
    {"surface_shader.specular_texture", Slot},
    {"surface_shader.shininess", Pair},
    {"surface_shader.shininess_texture", Slot},
    {"surface_shader.alpha", Number},
    {"surface_shader.alpha_texture", Slot},
    {"surface_shader.invert_alpha_texture", Truth},
    {"surface_shader.normal_texture", Slot},
    {"surface_shader.normal_format", {"snorm", "snorm", "float"}},
    {"surface_shader.normal_space", {"object", "object", "world"}},
    {"surface_shader.normal_scale", Color},
    {"surface_shader.normal_bias", Color},
    {"surface_shader.height_texture", Slot},
    {"surface_shader.height_scale", Number},
    {"surface_shader.reflection", Color},
    {"surface_shader.reflection_texture", Slot},
    {"surface_shader.transmission", Color},
    {"surface_shader.transmission_texture", Slot},
    {"surface_shader.relative_index_of_refraction", Color},
    {"surface_shader.fresnel_blend", Number},
    {"surface_shader.tangent_tex_coords", SignedWhole},
    {"surface_shader.binormal_tex_coords", SignedWhole},
    {"surface_shader.environment", Color},
    {"surface_shader.environment_texture", Slot},
    {"medium.emission", Color},
    {"medium.emission_texture", Slot},
    {"medium.absorption", Color},
    {"medium.absorption_texture", Slot},
    {"medium.scattering", Color},
    {"medium.scattering_texture", Slot},
    {"medium.anisotropy", Number},
    {"medium.priority", SignedWhole},
    {"geometry.medium", {"none", "none", "fog"}},
    {"light.radius", Number},
    {"light.size", Pair},
    {"light.angle", Number},
    {"camera.projection", {"orthographic", "orthographic", "flat"}},
    {"camera.orthographic_height", Number},
    {"camera.lens_radius", Number},
    {"camera.focus_distance", Number},
    {"camera.aperture", {"gaussian", "gaussian", "hexagon"}},
    {"background.visible", {"color", "color", "white"}},
    {"background.map_center", {"negative_z", "negative_z", "x"}},
    {"background.visible_color", {"0.8 0.1 0.1 0.5", "0.8 0.1 0.1 0.5", "0.8 0.1"}},
};

// Including the common fields and the arrays.
std::map<std::string, FieldCase> cases() {
    std::map<std::string, FieldCase> all = Cases;
    for (const char* kind : {"root", "transform", "geometry", "material", "texture", "light", "camera",
                             "background", "attachment", "surface_shader", "medium"}) {
        all[std::string(kind) + ".name"] = Name;
    }
    for (const char* array :
         {"geometry.indices", "geometry.positions", "geometry.normals", "geometry.tangents",
          "geometry.tex_coords", "geometry.tex_coords_1", "geometry.colors", "geometry.motion_positions",
          "geometry.motion_normals", "texture.texels"}) {
        all[array] = Blob;
    }
    return all;
}

TEST(Values, EveryFieldRoundTrips) {
    FakeTarget target;
    const PathIndex book(target.scene());
    const auto read = [&](const Word& word) { return book.read(target.scene(), word); };
    const auto write = [&](ObjectId id) { return book.path(target.scene(), id); };
    const auto all = cases();
    std::size_t seen = 0;
    for (const scene::KindRow& row : scene::Kinds) {
        const ObjectKind kind = row.kind;
        for (const unsigned field : fields_of(kind)) {
            ++seen;
            const std::string name =
                std::string(scene::name(kind)) + "." + std::string(scene::field_name(kind, field));
            SCOPED_TRACE(name);
            ASSERT_TRUE(all.contains(name)) << "a new field needs a case here";
            const FieldCase& one = all.at(name);
            EXPECT_EQ(find_field(kind, scene::field_name(kind, field)), field);
            EXPECT_NE(value_form(kind, field).text, "");
            EXPECT_EQ(value_form(kind, field).is_settable, !one.typed.empty());

            scene::Object object = default_object(kind);
            EXPECT_EQ(scene::kind(object), kind);
            EXPECT_THROW(read_value(object, field, split(one.wrong), 1, read), ScriptError);
            EXPECT_THROW(read_value(object, field, {}, 1, read), ScriptError);
            EXPECT_EQ(scene::differing_fields(object, default_object(kind)), 0u)
                << "a wrong value changed it";
            if (one.typed.empty()) continue;
            read_value(object, field, split(one.typed), 1, read);
            const scene::FieldMask changed = scene::differing_fields(object, default_object(kind));
            EXPECT_EQ(changed | (one.typed == "none" ? scene::field_bit(field) : scene::FieldMask{0}),
                      scene::field_bit(field));
            EXPECT_EQ(value_text(object, field, write), one.shown);

            scene::Object again = default_object(kind);
            read_value(again, field, split(value_text(object, field, write)), 1, read);
            EXPECT_EQ(scene::differing_fields(again, object), 0u) << "what is shown reads back";
        }
    }
    EXPECT_EQ(seen, all.size()) << "a case is for no field";
}

TEST(Values, ThreeNumbersKeepAlpha) {
    FakeTarget target;
    const std::string red = "materials/\"my \\\"red\\\"\"";
    ASSERT_TRUE(target.script("set " + red + ".diffuse 0.8 0.1 0.1")) << target.error();
    EXPECT_EQ(target.named<scene::Material>("my \"red\"").base_color, glm::vec4(0.8f, 0.1f, 0.1f, 0.75f));
    ASSERT_TRUE(target.script("set " + red + ".base_color 0.8,0.1,0.1,0.25")) << target.error();
    EXPECT_EQ(target.named<scene::Material>("my \"red\"").base_color.a, 0.25f);
}

TEST(Values, OmittedPartsOfATextureSlotAreKept) {
    FakeTarget target;
    ASSERT_TRUE(target.script("set materials/\"my \\\"red\\\"\".base_color_texture scale=4,5"))
        << target.error();
    const scene::TextureSlot& slot = target.named<scene::Material>("my \"red\"").base_color_texture;
    EXPECT_EQ(slot.texture, target.id_of("wood"));
    EXPECT_EQ(slot.scale, glm::vec2(4.0f, 5.0f));
    EXPECT_EQ(slot.offset, glm::vec2(0.25f, 0.5f));
    EXPECT_EQ(slot.rotation, 0.7f);
    ASSERT_TRUE(target.script("set materials/\"my \\\"red\\\"\".base_color_texture none")) << target.error();
    EXPECT_FALSE(target.named<scene::Material>("my \"red\"").base_color_texture.texture);
}

TEST(Values, NumbersAreFinite) {
    FakeTarget target;
    for (const char* value : {"inf", "-inf", "nan", "1e999", "1e39", "0x10", "1,", ",", "--1", "1e", ""}) {
        EXPECT_FALSE(target.script("set lights/bulb.inner_cone_angle " + std::string(value))) << value;
    }
}

TEST(Values, ErrorsNameTheNearest) {
    FakeTarget target;
    EXPECT_FALSE(target.script("set lights/bulb.intensty 1"));
    EXPECT_THAT(target.error(), HasSubstr("test.txt:1:17: "));
    EXPECT_THAT(target.error(), HasSubstr("did you mean 'intensity'?"));
    EXPECT_FALSE(target.script("set lights/bulb.kind spott"));
    EXPECT_THAT(
        target.error(),
        HasSubstr(
            "test.txt:1:22: 'spott' is not one of point, spot, directional, sphere or quad; did you mean"));
    EXPECT_FALSE(target.script("set lights/bulb.intensity 1 2 x"));
    EXPECT_THAT(target.error(), HasSubstr("test.txt:1:31: 'x' is not a valid number"));
    EXPECT_FALSE(target.script("set lights/bulb.intensity 1 2"));
    EXPECT_THAT(target.error(), HasSubstr("test.txt:1:30: the value is incomplete: write 3 numbers"));
    EXPECT_FALSE(target.script("set lights/bulb.intensity 1 2 3 4"));
    EXPECT_THAT(target.error(), HasSubstr("test.txt:1:33: '4' is not expected here"));
    EXPECT_FALSE(target.script("set textures/wood.texels 1"));
    EXPECT_THAT(target.error(), HasSubstr("load FILE"));
}

TEST(Values, RangesAreCheckedByTheScene) {
    FakeTarget target;
    EXPECT_FALSE(target.script("set materials/\"my \\\"red\\\"\".roughness 2"));
    EXPECT_THAT(target.error(), HasSubstr("test.txt:1:1: material 5"));
    EXPECT_FALSE(target.script("set geometries/square.material lights/bulb"));
    EXPECT_THAT(target.error(), HasSubstr("cannot have light"));
}

}  // namespace
}  // namespace tessera::edit
