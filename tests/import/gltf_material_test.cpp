#include "mediator/picture/png_writer.h"
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

namespace tessera::import {
namespace {

using scene::Material;
using scene::Texture;
using testing::ElementsAre;

// One triangle with two sets of texture coordinates per material of the file.
ImportedScene with_materials(SceneFile& file, const std::vector<std::string>& materials,
                             const ImportOptions& options = {}) {
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const int uv0 =
        file.accessor(file.view(std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}}), Component::Float, "VEC2", 3);
    const int uv1 =
        file.accessor(file.view(std::vector<glm::vec2>{{5, 5}, {6, 5}, {5, 6}}), Component::Float, "VEC2", 3);
    std::string primitives;
    for (const std::string& material : materials) {
        const int index = file.add("materials", material);
        primitives += std::string(primitives.empty() ? "" : ",") + R"({"attributes":{"POSITION":)" +
                      std::to_string(at) + R"(,"TEXCOORD_0":)" + std::to_string(uv0) + R"(,"TEXCOORD_1":)" +
                      std::to_string(uv1) + R"(},"material":)" + std::to_string(index) + "}";
    }
    file.add("meshes", R"({"name":"it","primitives":[)" + primitives + "]}");
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const TestFolder folder;
    ImportedScene scene = loaded(folder.write("scene.glb", file.glb()), options);
    expect_consistent(scene);
    return scene;
}

TEST(GltfMaterial, FactorsAndExtensionsAreRead) {
    SceneFile file;
    const ImportedScene scene = with_materials(file, {R"({"name":"full","doubleSided":true,"alphaMode":"MASK",
        "alphaCutoff":0.25,"emissiveFactor":[1,0.5,0],
        "pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,0.4],"metallicFactor":0.6,"roughnessFactor":0.7},
        "extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":8},"KHR_materials_unlit":{},
        "KHR_materials_ior":{"ior":1.33},"KHR_materials_transmission":{"transmissionFactor":0.9}}})",
                                                      R"({"name":"plain","alphaMode":"BLEND"})"});
    const Material& full = named<Material>(scene, "full");
    EXPECT_EQ(full.base_color, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_EQ(full.metallic, 0.6f);
    EXPECT_EQ(full.roughness, 0.7f);
    EXPECT_EQ(full.emission, glm::vec3(8, 4, 0));
    EXPECT_EQ(full.alpha_mode, scene::AlphaMode::Mask);
    EXPECT_EQ(full.alpha_cutoff, 0.25f);
    EXPECT_TRUE(full.double_sided);
    EXPECT_TRUE(full.unlit);
    EXPECT_EQ(full.index_of_refraction, 1.33f);
    EXPECT_EQ(full.transmission, 0.9f);

    const Material& plain = named<Material>(scene, "plain");
    EXPECT_EQ(plain.base_color, glm::vec4(1));
    EXPECT_EQ(plain.metallic, 1.0f);
    EXPECT_EQ(plain.roughness, 1.0f);
    EXPECT_EQ(plain.emission, glm::vec3(0));
    EXPECT_EQ(plain.alpha_mode, scene::AlphaMode::Blend);
    EXPECT_FALSE(plain.double_sided);
    EXPECT_FALSE(plain.unlit);
}

TEST(GltfMaterial, EveryLobeOfTheExtensionsIsRead) {
    SceneFile file;
    file.image(png(1, 1, {1, 2, 3, 4}));
    const ImportedScene scene = with_materials(file, {R"({"name":"all","extensions":{
        "KHR_materials_transmission":{"transmissionFactor":0.5,"transmissionTexture":{"index":0}},
        "KHR_materials_volume":{"thicknessFactor":0.25,"attenuationDistance":2,"attenuationColor":[0.5,0.25,1]},
        "KHR_materials_specular":{"specularFactor":0.75,"specularColorFactor":[2,0.5,1],
            "specularTexture":{"index":0},"specularColorTexture":{"index":0}},
        "KHR_materials_clearcoat":{"clearcoatFactor":0.8,"clearcoatRoughnessFactor":0.1,
            "clearcoatTexture":{"index":0},"clearcoatRoughnessTexture":{"index":0,"texCoord":1},
            "clearcoatNormalTexture":{"index":0,"scale":0.5}},
        "KHR_materials_sheen":{"sheenColorFactor":[0.1,0.2,0.3],"sheenRoughnessFactor":0.6,
            "sheenColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"offset":[0.5,0.25]}}},
            "sheenRoughnessTexture":{"index":0}},
        "KHR_materials_anisotropy":{"anisotropyStrength":0.7,"anisotropyRotation":1.5,"anisotropyTexture":{"index":0}},
        "KHR_materials_iridescence":{"iridescenceFactor":0.4,"iridescenceIor":1.7,"iridescenceThicknessMinimum":50,
            "iridescenceThicknessMaximum":600,"iridescenceTexture":{"index":0},
            "iridescenceThicknessTexture":{"index":0}}}})"});
    const Material& all = named<Material>(scene, "all");
    EXPECT_EQ(all.transmission, 0.5f);
    EXPECT_EQ(all.thickness, 0.25f);
    EXPECT_EQ(all.attenuation_distance, 2.0f);
    EXPECT_EQ(all.attenuation_color, glm::vec3(0.5f, 0.25f, 1.0f));
    EXPECT_EQ(all.specular, 0.75f);
    EXPECT_EQ(all.specular_color, glm::vec3(2.0f, 0.5f, 1.0f));
    EXPECT_EQ(all.clearcoat, 0.8f);
    EXPECT_EQ(all.clearcoat_roughness, 0.1f);
    EXPECT_EQ(all.clearcoat_normal_scale, 0.5f);
    EXPECT_EQ(all.clearcoat_roughness_texture.set, 1u);
    EXPECT_EQ(all.sheen_color, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(all.sheen_roughness, 0.6f);
    EXPECT_EQ(all.sheen_color_texture.offset, glm::vec2(0.5f, 0.25f));
    EXPECT_EQ(all.anisotropy, 0.7f);
    EXPECT_EQ(all.anisotropy_rotation, 1.5f);
    EXPECT_EQ(all.iridescence, 0.4f);
    EXPECT_EQ(all.iridescence_index_of_refraction, 1.7f);
    EXPECT_EQ(all.iridescence_thickness_minimum, 50.0f);
    EXPECT_EQ(all.iridescence_thickness_maximum, 600.0f);
    for (const scene::TextureSlot* data :
         {&all.transmission_texture, &all.specular_texture, &all.clearcoat_texture,
          &all.clearcoat_roughness_texture, &all.clearcoat_normal_texture, &all.sheen_roughness_texture,
          &all.anisotropy_texture, &all.iridescence_texture, &all.iridescence_thickness_texture}) {
        EXPECT_EQ(object<Texture>(scene, data->texture).format, scene::TexelFormat::Rgba8);
    }
    for (const scene::TextureSlot* color : {&all.specular_color_texture, &all.sheen_color_texture}) {
        EXPECT_EQ(object<Texture>(scene, color->texture).format, scene::TexelFormat::Rgba8Srgb);
    }
}

TEST(GltfMaterial, InvalidValuesInExtensionsAreIgnored) {
    SceneFile file;
    const ImportedScene scene = with_materials(file, {R"({"name":"odd","extensions":{
        "KHR_materials_clearcoat":7,"KHR_materials_sheen":{"sheenColorFactor":[1,2],"sheenRoughnessFactor":-3,
            "sheenColorTexture":"none"},
        "KHR_materials_specular":{"specularTexture":{"index":99},"specularColorFactor":"red"}}})"});
    const Material& odd = named<Material>(scene, "odd");
    EXPECT_EQ(odd.clearcoat, 0.0f);
    EXPECT_EQ(odd.sheen_color, glm::vec3(0.0f));
    EXPECT_EQ(odd.sheen_roughness, 0.0f);
    EXPECT_EQ(odd.specular_color, glm::vec3(1.0f));
    EXPECT_TRUE(
        has_notice(scene, "material 'odd': extensions/KHR_materials_sheen/sheenRoughnessFactor is -3"));
}

// glTF: thin-walled without KHR_materials_volume, unless --solid-glass.
TEST(GltfMaterial, GlassWithoutAVolumeIsThinWalledUnlessSolidGlass) {
    const std::string glass =
        R"({"name":"pane","extensions":{"KHR_materials_transmission":{"transmissionFactor":1}}})";
    SceneFile file;
    const ImportedScene thin = with_materials(file, {glass});
    EXPECT_EQ(named<Material>(thin, "pane").thickness, 0.0f);
    EXPECT_TRUE(has_notice(thin, "--solid-glass"));
    SceneFile again;
    const ImportedScene solid = with_materials(again, {glass}, {.glass = Glass::Solid});
    EXPECT_GT(named<Material>(solid, "pane").thickness, 0.0f);
    EXPECT_FALSE(has_notice(solid, "--solid-glass"));
}

TEST(GltfMaterial, NumbersOutOfRangeGetTheirDefaults) {
    SceneFile file;
    const ImportedScene scene = with_materials(file, {R"({"name":"wild","emissiveFactor":[-1,1e300,0],
        "pbrMetallicRoughness":{"baseColorFactor":[2,-1,0.5,1],"metallicFactor":-3,"roughnessFactor":7}})"});
    const Material& wild = named<Material>(scene, "wild");
    EXPECT_EQ(wild.base_color, glm::vec4(1.0f));
    EXPECT_EQ(wild.metallic, 1.0f);
    EXPECT_EQ(wild.roughness, 1.0f);
    EXPECT_EQ(wild.emission, glm::vec3(0.0f));
    EXPECT_TRUE(has_notice(scene, "material 'wild': pbrMetallicRoughness/metallicFactor is -3"));
}

TEST(GltfMaterial, AMissingMaterialIsTheDefaultOne) {
    SceneFile file;
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    file.add("meshes",
             R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + R"(},"material":7}]})");
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
    EXPECT_EQ(named<Material>(scene, "default").base_color, glm::vec4(1));
    EXPECT_TRUE(has_notice(scene, "material 7 is missing"));
}

TEST(GltfTexture, IsDecodedToTexelsFromTheTop) {
    SceneFile file;
    file.image(png(3, 2, {10, 20, 30, 40}));
    ImportOptions dark;  // without the texture of the default environment
    dark.background = glm::vec3(0.0f);
    const ImportedScene scene =
        with_materials(file, {R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})"}, dark);
    ASSERT_EQ(all<Texture>(scene).size(), 1u);
    const Texture& texture = *all<Texture>(scene)[0];
    EXPECT_EQ(texture.width, 3u);
    EXPECT_EQ(texture.height, 2u);
    EXPECT_EQ(texture.format, scene::TexelFormat::Rgba8Srgb);
    const auto texels = values<std::uint8_t>(scene, texture.texels);
    ASSERT_EQ(texels.size(), 24u);
    EXPECT_THAT(std::vector<int>(texels.begin() + 20, texels.end()), ElementsAre(10, 20, 30, 40));
    EXPECT_EQ(scene.counts.textures, 1u);
}

TEST(GltfTexture, UsedAsColorAndDataIsTwoObjectsOverOneBlob) {
    SceneFile file;
    file.image(png(1, 1, {1, 2, 3, 4}));
    const ImportedScene scene = with_materials(file, {R"({"name":"both","pbrMetallicRoughness":{
        "baseColorTexture":{"index":0},"metallicRoughnessTexture":{"index":0}}})"});
    const Material& both = named<Material>(scene, "both");
    const Texture& color = object<Texture>(scene, both.base_color_texture.texture);
    const Texture& data = object<Texture>(scene, both.metallic_roughness_texture.texture);
    EXPECT_EQ(color.format, scene::TexelFormat::Rgba8Srgb);
    EXPECT_EQ(data.format, scene::TexelFormat::Rgba8);
    EXPECT_EQ(color.texels, data.texels);
}

// Steps of 1/255 in normals are seen in mirrors; colours are kept in eight bits.
TEST(GltfTexture, SixteenBitsOfDataAreKept) {
    const std::vector<float> exact{0.5f, 12345.0f / 65535.0f, 1.0f};
    const std::vector<std::byte> bytes = picture::encode_png16(1, 1, exact);
    SceneFile file;
    file.image({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const ImportedScene scene = with_materials(file, {R"({"name":"both","pbrMetallicRoughness":{
        "baseColorTexture":{"index":0}},"normalTexture":{"index":0}})"});
    const Material& both = named<Material>(scene, "both");
    const Texture& color = object<Texture>(scene, both.base_color_texture.texture);
    const Texture& data = object<Texture>(scene, both.normal_texture.texture);
    EXPECT_EQ(color.format, scene::TexelFormat::Rgba8Srgb);
    EXPECT_EQ(data.format, scene::TexelFormat::RgbFloat);
    const auto found = values<float>(scene, data.texels);
    ASSERT_EQ(found.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], exact[i], 0.5f / 65535.0f + 1e-7f) << i;
}

TEST(GltfTexture, ATruncatedImageOfSixteenBitsIsReported) {
    const std::vector<std::byte> bytes = picture::encode_png16(64, 64, std::vector<float>(64 * 64 * 3, 0.3f));
    for (const std::size_t size : {bytes.size() / 2, std::size_t{40}, std::size_t{9}}) {
        SceneFile file;
        file.image({reinterpret_cast<const char*>(bytes.data()), size});
        const ImportedScene scene = with_materials(file, {R"({"name":"it","normalTexture":{"index":0}})"});
        EXPECT_FALSE(named<Material>(scene, "it").normal_texture.texture) << size;
        EXPECT_TRUE(has_notice(scene, "only the factor is used")) << size;
    }
}

TEST(GltfTexture, SamplersAndSharingAreKept) {
    SceneFile file;
    file.image(png(1, 1, {1, 2, 3, 4}));
    file.add("samplers", R"({"wrapS":33071,"wrapT":33648,"magFilter":9728})");
    file.add("textures", R"({"source":0,"sampler":0})");
    const ImportedScene scene =
        with_materials(file, {R"({"name":"a","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})",
                              R"({"name":"b","pbrMetallicRoughness":{"baseColorTexture":{"index":1}}})",
                              R"({"name":"c","pbrMetallicRoughness":{"baseColorTexture":{"index":1}}})"});
    const auto texture_of = [&](const char* name) {
        return named<Material>(scene, name).base_color_texture.texture;
    };
    EXPECT_NE(texture_of("a"), texture_of("b"));
    EXPECT_EQ(texture_of("b"), texture_of("c"));
    const Texture& plain = object<Texture>(scene, texture_of("a"));
    EXPECT_EQ(plain.wrap_s, scene::Wrap::Repeat);
    EXPECT_EQ(plain.filter, scene::TextureFilter::Linear);
    const Texture& special = object<Texture>(scene, texture_of("b"));
    EXPECT_EQ(special.wrap_s, scene::Wrap::Clamp);
    EXPECT_EQ(special.wrap_t, scene::Wrap::Mirror);
    EXPECT_EQ(special.filter, scene::TextureFilter::Nearest);
}

TEST(GltfTexture, TransformsAndCoordinateSetsAreKept) {
    SceneFile file;
    file.image(png(1, 1, {1, 2, 3, 4}));
    const ImportedScene scene =
        with_materials(file, {R"({"name":"moved","pbrMetallicRoughness":{"baseColorTexture":
        {"index":0,"extensions":{"KHR_texture_transform":{"offset":[0.5,0.25],"scale":[2,3],"rotation":1.5,
        "texCoord":1}}}}})"});
    const scene::TextureSlot& slot = named<Material>(scene, "moved").base_color_texture;
    EXPECT_EQ(slot.offset, glm::vec2(0.5f, 0.25f));
    EXPECT_EQ(slot.scale, glm::vec2(2, 3));
    EXPECT_EQ(slot.rotation, 1.5f);
    EXPECT_EQ(slot.set, 1u);
    const scene::Geometry& it = named<scene::Geometry>(scene, "it");
    EXPECT_EQ(values<glm::vec2>(scene, it.tex_coords)[0], glm::vec2(0, 0));
    EXPECT_EQ(values<glm::vec2>(scene, it.tex_coords_1)[0], glm::vec2(5, 5));
}

TEST(GltfTexture, AnUnusedSecondSetIsLeftOut) {
    SceneFile file;
    file.image(png(1, 1, {1, 2, 3, 4}));
    const ImportedScene scene =
        with_materials(file, {R"({"name":"one","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})"});
    EXPECT_TRUE(named<scene::Geometry>(scene, "it").tex_coords_1.empty());
}

TEST(GltfTexture, AThirdCoordinateSetIsNoticed) {
    SceneFile file;
    file.image(png(1, 1, {1, 2, 3, 4}));
    const ImportedScene scene = with_materials(file, {R"({"name":"many","pbrMetallicRoughness":{
        "baseColorTexture":{"index":0},"metallicRoughnessTexture":{"index":0,"texCoord":2}}})"});
    EXPECT_TRUE(has_notice(scene, "material 'many': its textures use more than two sets"));
}

// A material that uses the image of the file for colour and normals.
ImportedScene with_image(SceneFile& file) {
    ImportedScene scene = with_materials(file, {R"({"name":"shown","pbrMetallicRoughness":{
        "baseColorTexture":{"index":0}},"normalTexture":{"index":0}})"});
    const Material& shown = named<Material>(scene, "shown");
    const Texture& checker = object<Texture>(scene, shown.base_color_texture.texture);
    const auto texels = values<std::uint8_t>(scene, checker.texels);
    EXPECT_THAT(std::vector<int>(texels.begin(), texels.begin() + 8),
                ElementsAre(255, 0, 255, 255, 0, 0, 0, 255));
    EXPECT_FALSE(shown.normal_texture.texture) << "a checker of normals would be nonsense";
    EXPECT_EQ(scene.counts.placeholders, 1u);
    return scene;
}

TEST(GltfTexture, AMissingFileIsAMagentaCheckerboard) {
    SceneFile file;
    file.add("images", R"({"uri":"nowhere.png"})");
    file.add("textures", R"({"source":0})");
    const ImportedScene scene = with_image(file);
    EXPECT_TRUE(has_notice(scene, "there is no file 'nowhere.png'"));
    EXPECT_TRUE(has_notice(scene, "texture 'nowhere.png' cannot be used"));
}

TEST(GltfTexture, AMissingTextureIsAMagentaCheckerboard) {
    SceneFile file;
    EXPECT_TRUE(has_notice(with_image(file), "texture 0 cannot be used (the file has 0 textures"));
}

TEST(GltfTexture, NoiseIsAMagentaCheckerboard) {
    SceneFile file;
    file.image("this is not an image, whatever its type says");
    EXPECT_TRUE(has_notice(with_image(file), "cannot be used"));
}

TEST(GltfTexture, ATruncatedImageIsAMagentaCheckerboard) {
    SceneFile file;
    const std::string whole = png(16, 16, {1, 2, 3, 4});
    file.image(std::string_view(whole).substr(0, whole.size() / 2));
    EXPECT_TRUE(has_notice(with_image(file), "damaged"));
}

TEST(GltfTexture, ImagesWithAFalseSizeAreRejectedBeforeDecoding) {
    {
        SceneFile file;
        file.image(png(2, 2, {1, 2, 3, 4}, 16000, 8000));
        EXPECT_TRUE(has_notice(with_image(file), "claims 16000 x 8000 pixels, but has only"));
    }
    {
        SceneFile file;
        file.image(png(2, 2, {1, 2, 3, 4}, 16384, 16384));
        EXPECT_TRUE(has_notice(with_image(file), "claims 16384 x 16384 pixels, more than"));
    }
    {
        SceneFile file;
        file.image(png(2, 2, {1, 2, 3, 4}, 0x7fffffff, 0x7fffffff));
        EXPECT_TRUE(has_notice(with_image(file), "cannot be used"));
    }
    {
        SceneFile file;
        file.image(png(2, 2, {1, 2, 3, 4}, 40, 40));
        EXPECT_TRUE(has_notice(with_image(file), "damaged"));
    }
}

TEST(GltfTexture, AViewBeyondItsBufferIsAMagentaCheckerboard) {
    SceneFile file;
    file.add("bufferViews", R"({"buffer":0,"byteOffset":4000000000,"byteLength":4000000000})");
    file.add("images", R"({"bufferView":0,"mimeType":"image/png"})");
    file.add("textures", R"({"source":0})");
    EXPECT_TRUE(has_notice(with_image(file), "extends beyond its buffer"));
}

}  // namespace
}  // namespace tessera::import
