#include "mediator/picture/png_writer.h"
#include "mediator/scene/fields.h"
#include "tests/import/x3d_file.h"

// CommonSurfaceShader, CommonVolumeShader and Material, field by field.
namespace tessera::import {
namespace {

// An Appearance with the nodes, on a sphere; every image name exists.
ImportedScene read_appearance(const std::string& nodes, const std::string& version = "3.3",
                              const std::string& geometry = "<Sphere/>") {
    const TestFolder folder;
    for (const char* name : {"a", "b", "c"})
        folder.write(name + std::string(".png"), png(1, 1, {200, 100, 50, 255}));
    folder.write("grey.png", png(1, 1, {200, 200, 200, 255}));
    const std::vector<std::byte> deep =
        picture::encode_png16(1, 1, std::vector<float>{0.5f, 12345.0f / 65535.0f, 1.0f});
    folder.write("deep.png", {reinterpret_cast<const char*>(deep.data()), deep.size()});
    folder.write("clear.png", png(1, 1, {200, 100, 50, 128}));
    ImportedScene scene = loaded(folder.write(
        "a.x3d", x3d("<Shape><Appearance>" + nodes + "</Appearance>" + geometry + "</Shape>", version)));
    expect_consistent(scene);
    expect_valid(scene);
    return scene;
}

template <class T>
T only(const ImportedScene& scene) {
    const auto found = all<T>(scene);
    EXPECT_EQ(found.size(), 1u);
    return found.empty() ? T{} : *found.front();
}

// Names of the fields that differ, except for the name.
template <class T>
std::vector<std::string> differences(T a, T b) {
    a.name = b.name = "";
    const scene::FieldMask mask = scene::differing_fields(a, b);
    std::vector<std::string> names;
    for (unsigned field = 0; field < 64; ++field) {
        if (mask >> field & 1) names.emplace_back(scene::field_name(scene::kind(scene::Object(a)), field));
    }
    return names;
}

TEST(X3dSurfaceShader, AnEmptyOneHasTheDefaultsOfTheThesis) {
    const auto shader = only<scene::SurfaceShader>(read_appearance("<CommonSurfaceShader/>"));
    EXPECT_THAT(differences(shader, scene::SurfaceShader{}), testing::IsEmpty());
    EXPECT_EQ(shader.ambient, glm::vec3(0.2f));
    EXPECT_EQ(shader.diffuse, glm::vec3(0.8f));
    EXPECT_EQ(shader.shininess, glm::vec2(0.0f));
    EXPECT_EQ(shader.normal_scale, glm::vec3(2.0f));
    EXPECT_EQ(shader.normal_bias, glm::vec3(-1.0f));
    EXPECT_EQ(shader.relative_index_of_refraction, glm::vec3(1.0f));
    EXPECT_EQ(shader.fresnel_blend, 1.0f);
    EXPECT_EQ(shader.environment, glm::vec3(0.0f));
}

TEST(X3dSurfaceShader, DefaultsThatAreWrittenOutChangeNothing) {
    const ImportedScene scene = read_appearance(
        "<CommonSurfaceShader emissionFactor='0 0 0' ambientFactor='0.2 0.2 0.2' diffuseFactor='0.8 0.8 0.8' "
        "specularFactor='0 0 0' shininessFactor='0 0' alphaFactor='1' invertAlphaTexture='false' "
        "normalFormat='UNORM' normalSpace='TANGENT' normalScale='2 2 2' normalBias='-1 -1 -1' "
        "heightScale='1' "
        "reflectionFactor='0 0 0' transmissionFactor='0 0 0' relativeIndexOfRefraction='1 1 1' "
        "fresnelBlend='1.0' tangentTextureCoordinatesId='-1' binormalTextureCoordinatesId='-1' "
        "environmentFactor='0 0 0'/>");
    EXPECT_THAT(differences(only<scene::SurfaceShader>(scene), scene::SurfaceShader{}), testing::IsEmpty());
}

TEST(X3dSurfaceShader, SixteenBitsOfDataAreKept) {
    const ImportedScene scene = read_appearance(
        "<CommonSurfaceShader><ImageTexture containerField='normalTexture' url='deep.png'/>"
        "<ImageTexture containerField='diffuseTexture' url='deep.png'/></CommonSurfaceShader>");
    const auto shader = only<scene::SurfaceShader>(scene);
    const auto& normals = object<scene::Texture>(scene, shader.normal_texture.texture);
    EXPECT_EQ(object<scene::Texture>(scene, shader.diffuse_texture.texture).format,
              scene::TexelFormat::Rgba8Srgb);
    ASSERT_EQ(normals.format, scene::TexelFormat::RgbFloat);
    EXPECT_NEAR(values<float>(scene, normals.texels)[1], 12345.0f / 65535.0f, 1e-7f);
}

TEST(X3dSurfaceShader, EveryFieldIsRead) {
    const ImportedScene scene = read_appearance(
        "<CommonSurfaceShader DEF='s' emissionFactor='7 8 9' ambientFactor='0.1 0.2 0.3' diffuseFactor='0.2 "
        "0.3 "
        "0.4' specularFactor='0.3 0.4 0.5' shininessFactor='2 128' alphaFactor='0.5' "
        "invertAlphaTexture='true' "
        "normalFormat='SNORM' normalSpace='OBJECT' normalScale='1 -1 2' normalBias='0 0.5 -1' "
        "heightScale='0.01' "
        "reflectionFactor='0.4 0.5 0.6' transmissionFactor='0.5 0.6 0.7' relativeIndexOfRefraction='1.5 1.51 "
        "1.52' fresnelBlend='0.25' tangentTextureCoordinatesId='0' binormalTextureCoordinatesId='1' "
        "environmentFactor='0.6 0.7 0.8'>"
        "<ImageTexture containerField='emissionTexture' DEF='emission' url='a.png'/>"
        "<ImageTexture containerField='ambientTexture' DEF='ambient' url='b.png'/>"
        "<ImageTexture containerField='diffuseTexture' DEF='diffuse' url='c.png'/>"
        "<ImageTexture containerField='specularTexture' DEF='specular' url='a.png'/>"
        "<ImageTexture containerField='shininessTexture' DEF='shininess' url='b.png'/>"
        "<ImageTexture containerField='alphaTexture' DEF='alpha' url='c.png'/>"
        "<ImageTexture containerField='normalTexture' DEF='normal' url='a.png'/>"
        "<ImageTexture containerField='heightTexture' DEF='height' url='b.png'/>"
        "<ImageTexture containerField='reflectionTexture' DEF='reflection' url='c.png'/>"
        "<ImageTexture containerField='transmissionTexture' DEF='transmission' url='a.png'/>"
        "<ImageTexture containerField='environmentTexture' DEF='environment' url='b.png'/>"
        "</CommonSurfaceShader>");
    const auto shader = only<scene::SurfaceShader>(scene);
    EXPECT_EQ(shader.name, "s");
    EXPECT_EQ(differences(shader, scene::SurfaceShader{}).size(), row_count<scene::SurfaceShader> - 1)
        << "every field but the name";
    EXPECT_EQ(shader.emission, glm::vec3(7, 8, 9));
    EXPECT_EQ(shader.ambient, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(shader.diffuse, glm::vec3(0.2f, 0.3f, 0.4f));
    EXPECT_EQ(shader.specular, glm::vec3(0.3f, 0.4f, 0.5f));
    EXPECT_EQ(shader.shininess, glm::vec2(2, 128));
    EXPECT_EQ(shader.alpha, 0.5f);
    EXPECT_TRUE(shader.invert_alpha_texture);
    EXPECT_EQ(shader.normal_format, scene::NormalFormat::Snorm);
    EXPECT_EQ(shader.normal_space, scene::NormalSpace::Object);
    EXPECT_EQ(shader.normal_scale, glm::vec3(1, -1, 2));
    EXPECT_EQ(shader.normal_bias, glm::vec3(0, 0.5f, -1));
    EXPECT_EQ(shader.height_scale, 0.01f);
    EXPECT_EQ(shader.reflection, glm::vec3(0.4f, 0.5f, 0.6f));
    EXPECT_EQ(shader.transmission, glm::vec3(0.5f, 0.6f, 0.7f));
    EXPECT_EQ(shader.relative_index_of_refraction, glm::vec3(1.5f, 1.51f, 1.52f));
    EXPECT_EQ(shader.fresnel_blend, 0.25f);
    EXPECT_EQ(shader.tangent_tex_coords, 0);
    EXPECT_EQ(shader.binormal_tex_coords, 1);
    EXPECT_EQ(shader.environment, glm::vec3(0.6f, 0.7f, 0.8f));
    const auto expect_texture = [&](const scene::TextureSlot& slot, const char* name,
                                    scene::TexelFormat format) {
        EXPECT_EQ(object<scene::Texture>(scene, slot.texture).name, name);
        EXPECT_EQ(object<scene::Texture>(scene, slot.texture).format, format) << name;
    };
    using enum scene::TexelFormat;
    expect_texture(shader.emission_texture, "emission", Rgba8Srgb);
    expect_texture(shader.ambient_texture, "ambient", Rgba8Srgb);
    expect_texture(shader.diffuse_texture, "diffuse", Rgba8Srgb);
    expect_texture(shader.specular_texture, "specular", Rgba8Srgb);
    expect_texture(shader.shininess_texture, "shininess", Rgba8);
    expect_texture(shader.alpha_texture, "alpha", Rgba8);
    expect_texture(shader.normal_texture, "normal", Rgba8);
    expect_texture(shader.height_texture, "height", Rgba8);
    expect_texture(shader.reflection_texture, "reflection", Rgba8Srgb);
    expect_texture(shader.transmission_texture, "transmission", Rgba8Srgb);
    expect_texture(shader.environment_texture, "environment", Rgba8Srgb);
    EXPECT_FALSE(only_geometry(scene).tangents.empty());
}

TEST(X3dSurfaceShader, TheOtherSpellings) {
    const ImportedScene scene = read_appearance(
        "<CommonSurfaceShader emissiveFactor='1 2 3' shininessFactor='0.5' relativeIndexOfRefraction='1.4' "
        "normalFormat='\"SNORM\"'><ImageTexture containerField='emissiveTexture' "
        "url='a.png'/></CommonSurfaceShader>");
    const auto shader = only<scene::SurfaceShader>(scene);
    EXPECT_EQ(shader.emission, glm::vec3(1, 2, 3));
    EXPECT_TRUE(shader.emission_texture.texture);
    EXPECT_EQ(shader.shininess, glm::vec2(0.5f));
    EXPECT_EQ(shader.relative_index_of_refraction, glm::vec3(1.4f));
    EXPECT_EQ(shader.normal_format, scene::NormalFormat::Snorm);
    EXPECT_EQ(scene.counts.emissive_geometries, 1u);
}

TEST(X3dSurfaceShader, InvalidValuesAreReportedAndGetTheirDefaults) {
    const ImportedScene scene = read_appearance(
        "<CommonSurfaceShader DEF='gold' diffuseFactor='2 0 0' shininessFactor='1 2 3' alphaFactor='-0.5' "
        "relativeIndexOfRefraction='0' fresnelBlend='nan' normalSpace='WORLD' "
        "tangentTextureCoordinatesId='0.5'>"
        "<ImageTexture url='a.png'/><ImageTexture containerField='specularTexture' url='lost.png'/>"
        "<ImageTexture containerField='normalTexture' url='lost.png'/></CommonSurfaceShader>");
    for (const char* problem :
         {"<CommonSurfaceShader DEF='gold'> diffuseFactor is '2 0 0', outside 0 to 1",
          "shininessFactor is '1 2 3', not 2 numbers", "alphaFactor is '-0.5', outside 0 to 1",
          "relativeIndexOfRefraction is '0', outside 0.01 to 100",
          "fresnelBlend is 'nan', 'nan' is not a valid number",
          "normalSpace is 'WORLD', neither TANGENT nor OBJECT",
          "tangentTextureCoordinatesId is not an integer", "<ImageTexture> skipped",
          "<ImageTexture> of <CommonSurfaceShader DEF='gold'>'s specularTexture cannot be used (there is no "
          "file "
          "'lost.png'",
          "<ImageTexture> of <CommonSurfaceShader DEF='gold'>'s normalTexture cannot be used (there is no "
          "file "
          "'lost.png'"}) {
        EXPECT_TRUE(has_notice(scene, problem));
    }
    const auto shader = only<scene::SurfaceShader>(scene);
    EXPECT_THAT(differences(shader, scene::SurfaceShader{}), testing::ElementsAre("specular_texture"))
        << "the magenta checkerboard; a missing normal map is ignored";
}

TEST(X3dSurfaceShader, ItReplacesAMaterialAndIsShared) {
    const TestFolder folder;
    const std::string shape =
        "<Shape><Appearance><Material/><CommonSurfaceShader USE='s'/></Appearance><Box/></Shape>";
    const ImportedScene scene = loaded(folder.write(
        "a.x3d", x3d("<Shape><Appearance><Material/><CommonSurfaceShader DEF='s' diffuseFactor='1 0 0'/>"
                     "</Appearance><Sphere/></Shape>" +
                     shape)));
    EXPECT_EQ(only<scene::SurfaceShader>(scene).diffuse, glm::vec3(1, 0, 0));
    EXPECT_TRUE(all<scene::Material>(scene).empty());
    EXPECT_EQ(scene.counts.geometries, 2u);
}

TEST(X3dSurfaceShader, AnAnisotropicHighlightHasTangents) {
    const auto has_tangents = [](const std::string& shininess) {
        const ImportedScene scene =
            read_appearance("<CommonSurfaceShader shininessFactor='" + shininess + "'/>");
        return !only_geometry(scene).tangents.empty();
    };
    EXPECT_TRUE(has_tangents("1 2"));
    EXPECT_FALSE(has_tangents("2 2"));
}

// Of a sphere of radius 1, with both sides: pi L 2 A / (4 pi R^2) in the sphere around its box, R^2 = 3, so
// about 2.1 L against 0.2 (EmissiveLights).
TEST(X3dMaterial, FaintEmissionIsNoLight) {
    EXPECT_TRUE(has_notice(read_appearance("<Material emissiveColor='0.05 0.05 0.05'/>"),
                           "only faint emission as light"));
    for (const char* emissive :
         {"<Material emissiveColor='0.2 0.2 0.2'/>", "<CommonSurfaceShader emissionFactor='0.2 0.2 0.2'/>",
          "<Material/><CommonVolumeShader emissionFactor='0.01 0 0'/>"}) {
        EXPECT_FALSE(has_notice(read_appearance(emissive), "default environment")) << emissive;
    }
}

TEST(X3dMaterial, DefaultsAndFields) {
    const auto plain = only<scene::SurfaceShader>(read_appearance("<Material/>"));
    EXPECT_THAT(differences(plain, scene::SurfaceShader{}),
                testing::UnorderedElementsAre("ambient", "shininess"));
    EXPECT_EQ(plain.shininess, glm::vec2(0.2f));
    EXPECT_FLOAT_EQ(plain.ambient.x, 0.16f);
    const auto material = only<scene::SurfaceShader>(read_appearance(
        "<Material DEF='m' diffuseColor='0.1 0.2 0.3' specularColor='0.4 0.5 0.6' shininess='1' "
        "emissiveColor='3 2 1' transparency='0.25' ambientIntensity='1'/>"));
    EXPECT_EQ(material.name, "m");
    EXPECT_EQ(material.diffuse, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(material.ambient, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(material.specular, glm::vec3(0.4f, 0.5f, 0.6f));
    EXPECT_EQ(material.shininess, glm::vec2(1.0f));
    EXPECT_EQ(material.emission, glm::vec3(3, 2, 1));
    EXPECT_EQ(material.alpha, 0.75f);
}

TEST(X3dMaterial, ImagesAndVertexColoursReplaceTheDiffuseColour) {
    const auto diffuse = [](const std::string& picture, const std::string& version) {
        const ImportedScene scene = read_appearance(
            "<Material diffuseColor='0.5 0.5 0.5'/><ImageTexture url='" + picture + "'/>", version);
        return only<scene::SurfaceShader>(scene).diffuse.x;
    };
    EXPECT_EQ(diffuse("a.png", "3.3"), 1.0f);
    EXPECT_EQ(diffuse("grey.png", "3.3"), 0.5f) << "an intensity scales it";
    EXPECT_EQ(diffuse("a.png", "4.0"), 0.5f) << "X3D 4 multiplies";
    const ImportedScene clear = read_appearance("<Material/><ImageTexture url='clear.png'/>");
    EXPECT_TRUE(only<scene::SurfaceShader>(clear).alpha_texture.texture);
    const ImportedScene colored = read_appearance("<Material/>", "3.3",
                                                  "<IndexedFaceSet coordIndex='0 1 2'><Coordinate point='0 0 "
                                                  "0 1 0 0 0 1 0'/><Color color='1 0 0 0 1 0 0 0 "
                                                  "1'/></IndexedFaceSet>");
    EXPECT_EQ(only<scene::SurfaceShader>(colored).diffuse, glm::vec3(1.0f));
}

TEST(X3dMaterial, WithoutOneASurfaceIsUnlit) {
    const auto white = only<scene::Material>(read_x3d("<Shape><Sphere/></Shape>"));
    EXPECT_TRUE(white.unlit);
    EXPECT_EQ(white.base_color, glm::vec4(1.0f));
    const auto picture = only<scene::Material>(read_appearance("<ImageTexture url='clear.png'/>"));
    EXPECT_TRUE(picture.unlit);
    EXPECT_EQ(picture.alpha_mode, scene::AlphaMode::Blend);
}

TEST(X3dVolumeShader, AloneItHasNoSurface) {
    const scene::Geometry fog = only_geometry(read_appearance("<CommonVolumeShader/>"));
    EXPECT_TRUE(fog.medium);
    EXPECT_FALSE(fog.material);
    EXPECT_TRUE(only_geometry(read_appearance("<Material/><CommonVolumeShader/>")).material);
}

TEST(X3dVolumeShader, DefaultsAndFields) {
    const ImportedScene empty = read_appearance("<CommonSurfaceShader/><CommonVolumeShader/>");
    EXPECT_THAT(differences(only<scene::Medium>(empty), scene::Medium{}), testing::IsEmpty());
    EXPECT_EQ(only_geometry(empty).medium, empty.objects.at(1).id);

    const ImportedScene full = read_appearance(
        "<Material/><CommonVolumeShader DEF='fog' emissionFactor='1 2 3' absorptionFactor='4 5 6' "
        "scatteringFactor='7 8 9' priority='-2'><HenyeyGreenstein containerField='phaseFunction' "
        "anisotropy='0.5'/>"
        "<ImageTexture containerField='emissionTexture' url='a.png'/><ImageTexture "
        "containerField='absorptionTexture' url='a.png'/><ImageTexture containerField='scatteringTexture' "
        "url='b.png'/></CommonVolumeShader>");
    const auto fog = only<scene::Medium>(full);
    EXPECT_EQ(differences(fog, scene::Medium{}).size(), row_count<scene::Medium> - 1);
    EXPECT_EQ(fog.emission, glm::vec3(1, 2, 3));
    EXPECT_EQ(fog.absorption, glm::vec3(4, 5, 6));
    EXPECT_EQ(fog.scattering, glm::vec3(7, 8, 9));
    EXPECT_EQ(fog.anisotropy, 0.5f);
    EXPECT_EQ(fog.priority, -2);
    EXPECT_EQ(full.counts.emissive_geometries, 1u);
    EXPECT_TRUE(has_notice(read_appearance("<CommonVolumeShader scatteringFactor='-1 0 0'><Rayleigh "
                                           "containerField='phaseFunction'/></CommonVolumeShader>"),
                           "<Rayleigh> is an unknown phase function"));
}

}  // namespace
}  // namespace tessera::import
