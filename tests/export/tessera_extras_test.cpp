// Properties that glTF lacks are restored from tessera_* extras of a .glb; other programs see the nearest
// equivalent.
#include <algorithm>
#include <fstream>
#include <numbers>

#include "client/export/export.h"
#include "client/export/nearest_material.h"
#include "mediator/scene/fields.h"
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

namespace tessera::exporting {
namespace {

using Imported = import::ImportedScene;

constexpr ObjectId Color{10}, Data{11}, Cloud{12}, Paint{20}, Filling{21}, Triangle{30};

// A scene with some objects at the root, textures and a triangle.
struct TesseraExtras : testing::Test {
    ObjectId add(scene::Object object) {
        const ObjectId id{100 + entries.size()};
        entries.push_back(scene::Create{id, std::move(object)});
        root.children.push_back(id);
        return id;
    }
    template <class T>
    scene::BlobRef blob(const std::vector<T>& values) {
        return scene::reference(*blobs.insert(std::as_bytes(std::span(values))));
    }
    void add_textures() {
        std::vector<std::uint8_t> texels;
        for (int i = 0; i < 2 * 3 * 4 * 4; ++i) texels.push_back(static_cast<std::uint8_t>(i * 53));
        scene::Texture map{.name = "color",
                           .width = 2,
                           .height = 12,
                           .format = scene::TexelFormat::Rgba8Srgb,
                           .texels = blob(texels)};
        entries.push_back(scene::Create{Color, map});
        map.name = "data";
        map.format = scene::TexelFormat::Rgba8;
        entries.push_back(scene::Create{Data, map});
        map.name = "cloud";
        map.height = 3;
        map.depth = 4;
        entries.push_back(scene::Create{Cloud, map});
    }
    void add_triangle(ObjectId material, ObjectId medium) {
        scene::Geometry triangle{.name = "triangle", .material = material, .medium = medium};
        triangle.indices = blob<std::uint32_t>({0, 1, 2});
        triangle.positions = blob<glm::vec3>({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
        entries.push_back(scene::Create{Triangle, triangle});
        root.children.push_back(Triangle);
    }
    // `as_others`: as other programs read it, without tessera_* extras.
    Imported through_glb(bool as_others = false) {
        if (std::none_of(entries.begin(), entries.end(), is_geometry)) add_triangle({}, {});
        std::vector<scene::Entry> all = entries;
        all.insert(all.begin(), scene::Create{scene::RootId, root});
        scene::Scene scene;
        const auto applied = scene.apply_entries(all);
        if (!applied) ADD_FAILURE() << applied.error().what();
        const import::TestFolder folder;
        const auto file = folder.path() / "scene.glb";
        const auto written = write_glb(scene, blobs, file);
        if (!written) ADD_FAILURE() << written.error().what();
        notices = written.value_or(Notices{});
        if (as_others) forget_extras(file);
        Imported imported = import::loaded(file);
        import::expect_consistent(imported);
        import::expect_valid(imported);
        return imported;
    }
    static bool is_geometry(const scene::Entry& entry) {
        return std::holds_alternative<scene::Geometry>(std::get<scene::Create>(entry).object);
    }
    static void forget_extras(const std::filesystem::path& file) {
        std::ifstream in(file, std::ios::binary);
        std::string bytes{std::istreambuf_iterator<char>(in), {}};
        for (std::size_t at = 0; (at = bytes.find("tessera_", at)) != std::string::npos;) bytes[at] = 'T';
        std::ofstream(file, std::ios::binary) << bytes;
    }

    scene::Root root;
    std::vector<scene::Entry> entries;
    scene::BlobStore blobs;
    Notices notices;
};

// All fields except the name; textures by name, since ids differ between scenes.
template <class T>
void expect_same(const T& expected, T found, const Imported& imported) {
    const auto name_of = [](ObjectId id) { return id == Color ? "color" : id == Data ? "data" : "cloud"; };
    scene::for_each_field<T>([&](unsigned, auto member) {
        using Value = std::remove_cvref_t<decltype(std::declval<T&>().*member)>;
        if constexpr (std::is_same_v<Value, scene::TextureSlot>) {
            const ObjectId used = (expected.*member).texture;
            if (!used || !(found.*member).texture) return;
            const auto& texture = import::object<scene::Texture>(imported, (found.*member).texture);
            EXPECT_EQ(texture.name.substr(0, 4), std::string(name_of(used)).substr(0, 4));
            (found.*member).texture = used;
        }
    });
    found.name = expected.name;
    for (unsigned field = 0; field < row_count<T>; ++field) {
        if ((scene::differing_fields(expected, found) >> field) & 1)
            ADD_FAILURE() << scene::field_name(scene::kind(scene::Object(expected)), field);
    }
}

// Fails if a field is added later.
template <class T>
void expect_all_fields_differ(const T& object, scene::FieldMask except = 0) {
    EXPECT_EQ(scene::differing_fields(object, T{}) | except, scene::Fields<T>::all().bits());
}

scene::Light light_of(scene::LightKind kind) {
    scene::Light light{.name = "lamp", .kind = kind, .intensity = {2.0f, 1.0f, 0.5f}};
    light.inner_cone_angle = 0.25f;
    light.outer_cone_angle = 0.75f;
    light.radius = 0.3f;
    light.size = {0.1f, 7.5f};
    light.angle = 0.0047f;
    return light;
}

TEST_F(TesseraExtras, OfLightsOfEveryKindAreRestored) {
    using enum scene::LightKind;
    for (const scene::LightKind kind : {Point, Spot, Directional, Sphere, Quad}) {
        for (scene::Light light :
             {light_of(kind), scene::Light{.name = "lamp", .kind = kind, .intensity = {2.0f, 1.0f, 0.5f}}}) {
            root.children.clear();
            entries.clear();
            add(light);
            const Imported imported = through_glb();
            EXPECT_FALSE(import::has_notice(imported, "lamp"));
            expect_same(light, import::named<scene::Light>(imported, "lamp"), imported);
            EXPECT_TRUE(notices.empty());
        }
    }
    expect_all_fields_differ(light_of(Sphere));
}

TEST_F(TesseraExtras, OfLightsHaveTheNearestTypeForOtherPrograms) {
    add(light_of(scene::LightKind::Sphere));
    scene::Light quad = light_of(scene::LightKind::Quad);
    quad.name = "panel";
    add(quad);
    const Imported imported = through_glb(true);
    const auto& point = import::named<scene::Light>(imported, "lamp");
    EXPECT_EQ(point.kind, scene::LightKind::Point);
    EXPECT_EQ(point.intensity, glm::vec3(2.0f, 1.0f, 0.5f));
    const auto& spot = import::named<scene::Light>(imported, "panel");
    EXPECT_EQ(spot.kind, scene::LightKind::Spot);
    EXPECT_EQ(spot.intensity, glm::vec3(2.0f, 1.0f, 0.5f));
    EXPECT_EQ(spot.inner_cone_angle, 0.0f);
    EXPECT_NEAR(spot.outer_cone_angle, std::numbers::pi / 2, 1e-6) << "the half space before it";
}

TEST_F(TesseraExtras, OfCamerasAreRestored) {
    scene::Camera lens{.name = "lens", .vertical_fov = 0.5, .aspect_ratio = 1.25};
    lens.orthographic_height = 3.5;
    lens.lens_radius = 0.0125;
    lens.focus_distance = 4.2;
    lens.aperture = scene::Aperture::Gaussian;
    scene::Camera parallel = lens;
    parallel.name = "parallel";
    parallel.projection = scene::Projection::Orthographic;
    parallel.aspect_ratio = 0.0;
    const scene::Camera plain{.name = "plain"};
    for (const scene::Camera& camera : {lens, parallel, plain}) add(camera);
    const Imported imported = through_glb();
    for (const scene::Camera& camera : {lens, parallel, plain}) {
        SCOPED_TRACE(camera.name);
        expect_same(camera, import::named<scene::Camera>(imported, camera.name), imported);
    }
    parallel.aspect_ratio = 1.25;
    expect_all_fields_differ(parallel);
}

scene::SurfaceShader full_shader() {
    scene::SurfaceShader shader{.name = "all of it"};
    const scene::TextureSlot color{Color, {0.25f, 0.5f}, {2.0f, -3.0f}, 0.7f, 1}, data{.texture = Data};
    shader.emission = {3.0f, 0.5f, 0.0f};
    shader.ambient = {0.3f, 0.2f, 0.1f};
    shader.diffuse = {0.1f, 0.2f, 0.3f};
    shader.specular = {0.4f, 0.3f, 0.2f};
    shader.shininess = {0.1f, 511.9f};
    shader.alpha = 0.625f;
    shader.invert_alpha_texture = true;
    shader.normal_format = scene::NormalFormat::Snorm;
    shader.normal_space = scene::NormalSpace::Object;
    shader.normal_scale = {1.5f, 2.0f, 2.5f};
    shader.normal_bias = {-0.5f, -1.0f, -1.5f};
    shader.height_scale = -0.01f;
    shader.reflection = {0.7f, 0.8f, 0.9f};
    shader.transmission = {0.9f, 0.8f, 0.7f};
    shader.relative_index_of_refraction = {1.4f, 1.5f, 1.6f};
    shader.fresnel_blend = 0.3f;
    shader.tangent_tex_coords = 0;
    shader.binormal_tex_coords = 1;
    shader.environment = {10.0f, 0.0f, 1e5f};
    shader.emission_texture = shader.ambient_texture = shader.diffuse_texture = shader.specular_texture =
        color;
    shader.reflection_texture = shader.transmission_texture = shader.environment_texture = color;
    shader.shininess_texture = shader.alpha_texture = shader.normal_texture = shader.height_texture = data;
    return shader;
}

TEST_F(TesseraExtras, OfSurfaceShadersAreRestored) {
    expect_all_fields_differ(full_shader());
    for (const scene::SurfaceShader& shader : {full_shader(), scene::SurfaceShader{.name = "plain"}}) {
        root.children.clear();
        entries.clear();
        add_textures();
        entries.push_back(scene::Create{Paint, shader});
        add_triangle(Paint, {});
        const Imported imported = through_glb();
        const auto& found = import::named<scene::SurfaceShader>(imported, shader.name);
        expect_same(shader, found, imported);
        EXPECT_EQ(import::all<scene::Material>(imported).size(), 0u);
        EXPECT_TRUE(notices.empty());
        for (const auto* texture : import::all<scene::Texture>(imported)) {
            if (texture->format == scene::TexelFormat::RgbFloat) continue;  // the default environment
            EXPECT_EQ(texture->format, texture->name.starts_with("data") ? scene::TexelFormat::Rgba8
                                                                         : scene::TexelFormat::Rgba8Srgb);
        }
    }
}

TEST_F(TesseraExtras, OfSurfaceShadersAreTheNearestMaterialForOtherPrograms) {
    add_textures();
    entries.push_back(scene::Create{Paint, full_shader()});
    add_triangle(Paint, {});
    const Imported imported = through_glb(true);
    const auto& material = import::named<scene::Material>(imported, "all of it");
    EXPECT_EQ(material.alpha_mode, scene::AlphaMode::Blend);
    EXPECT_EQ(material.base_color.a, 0.625f);
    EXPECT_EQ(material.emission, glm::vec3(3.0f, 0.5f, 0.0f));
    EXPECT_TRUE(material.base_color_texture.texture);
    EXPECT_GT(material.transmission, 0.5f);
}

// Diffuse and specular energy equal those of the shader for grey colours.
TEST(NearestMaterial, ReflectsAndScattersAsMuch) {
    for (const float diffuse : {0.0f, 0.3f, 0.6f}) {
        for (const float specular : {0.0f, 0.1f, 0.4f}) {
            scene::SurfaceShader shader;
            shader.diffuse = glm::vec3(diffuse);
            shader.specular = glm::vec3(specular);
            shader.shininess = glm::vec2(2.0f);
            const scene::Material material = nearest_material(shader);
            EXPECT_NEAR(material.metallic * material.base_color.r, specular, 1e-6f);
            EXPECT_NEAR((1.0f - material.metallic) * material.base_color.r, diffuse, 1e-6f);
            EXPECT_EQ(material.specular, 0.0f);
            if (specular == 0.0f) continue;
            EXPECT_NEAR(std::pow(material.roughness, 4.0f), 2.0f / 258.0f, 1e-6f);
        }
    }
}

TEST(NearestMaterial, OfGlassIsGlass) {
    scene::SurfaceShader shader;
    shader.diffuse = glm::vec3(0.0f);
    shader.reflection = shader.transmission = glm::vec3(1.0f);
    shader.relative_index_of_refraction = glm::vec3(1.5f);
    const scene::Material material = nearest_material(shader);
    EXPECT_EQ(material.transmission, 1.0f);
    EXPECT_EQ(material.metallic, 0.0f);
    EXPECT_EQ(material.roughness, 0.0f);
    EXPECT_EQ(material.index_of_refraction, 1.5f);
    EXPECT_GT(material.thickness, 0.0f) << "solid glass";
    shader.transmission = glm::vec3(0.0f);
    shader.fresnel_blend = 0.0f;
    EXPECT_EQ(nearest_material(shader).metallic, 1.0f) << "a mirror";
}

TEST_F(TesseraExtras, OfMediaAreRestored) {
    scene::Medium cloud{.name = "fog bank"};
    cloud.emission = {0.1f, 0.0f, 2.0f};
    cloud.absorption = {0.5f, 1e-6f, 1e6f};
    cloud.scattering = {3.0f, 4.0f, 5.0f};
    cloud.anisotropy = -0.4f;
    cloud.priority = -7;
    cloud.emission_texture = {.texture = Color};
    cloud.absorption_texture = cloud.scattering_texture = {.texture = Cloud};
    expect_all_fields_differ(cloud);
    for (const scene::Medium& medium : {cloud, scene::Medium{.name = "air"}}) {
        for (const ObjectId paint : {ObjectId{}, Paint}) {
            root.children.clear();
            entries.clear();
            add_textures();
            entries.push_back(scene::Create{Paint, scene::Material{.name = "skin"}});
            entries.push_back(scene::Create{Filling, medium});
            add_triangle(paint, Filling);
            const Imported imported = through_glb();
            expect_same(medium, import::named<scene::Medium>(imported, medium.name), imported);
            const auto geometries = import::all<scene::Geometry>(imported);
            ASSERT_EQ(geometries.size(), 1u);
            EXPECT_TRUE(geometries[0]->medium);
            EXPECT_EQ(geometries[0]->material.value != 0, paint.value != 0)
                << "a medium boundary without a surface";
            if (!medium.absorption_texture.texture) continue;
            const auto& texture = import::object<scene::Texture>(
                imported, import::named<scene::Medium>(imported, medium.name).absorption_texture.texture);
            EXPECT_EQ(glm::uvec3(texture.width, texture.height, texture.depth), glm::uvec3(2, 3, 4));
        }
    }
}

TEST_F(TesseraExtras, OfShadowCatchersAreRestored) {
    entries.push_back(scene::Create{Paint, scene::Material{.name = "floor", .shadow_catcher = true}});
    add_triangle(Paint, {});
    EXPECT_TRUE(import::named<scene::Material>(through_glb(), "floor").shadow_catcher);
}

}  // namespace
}  // namespace tessera::exporting
