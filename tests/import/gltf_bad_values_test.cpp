#include <limits>

#include "mediator/scene/fields.h"
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

// Invalid values in glTF materials: reported with file, material, field and remedy, and replaced by defaults.
namespace tessera::import {
namespace {

using scene::Material;

ImportedScene with_material(const std::string& material) {
    SceneFile file;
    file.image(png(1, 1, {1, 2, 3, 4}));
    file.add("materials", material);
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    file.add("meshes",
             R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + R"(},"material":0}]})");
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const TestFolder folder;
    ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
    expect_consistent(scene);
    expect_valid(scene);
    return scene;
}

struct Case {
    std::string field;  // JSON path, separated by '/'
    std::string value;
    std::string cause;
};

// The field as JSON, within its parent objects.
std::string nested(const std::string& path, const std::string& value) {
    const std::size_t slash = path.find('/');
    if (slash == path.npos) return '"' + path + "\":" + value;
    return '"' + path.substr(0, slash) + "\":{" + nested(path.substr(slash + 1), value) + "}";
}

void expect_default(const Case& wrong) {
    SCOPED_TRACE(wrong.field + " " + wrong.value);
    const ImportedScene scene = with_material(R"({"name":"paint",)" + nested(wrong.field, wrong.value) + "}");
    EXPECT_TRUE(has_notice(scene, "material 'paint': " + wrong.field + " is "));
    EXPECT_TRUE(has_notice(scene, ", " + wrong.cause + ": its default is used, correct it"));
    static const Material plain = named<Material>(with_material(R"({"name":"paint"})"), "paint");
    EXPECT_EQ(scene::differing_fields(named<Material>(scene, "paint"), plain), 0u);
}

constexpr const char* Numbers[] = {"pbrMetallicRoughness/metallicFactor",
                                   "pbrMetallicRoughness/roughnessFactor",
                                   "extensions/KHR_materials_transmission/transmissionFactor",
                                   "extensions/KHR_materials_specular/specularFactor",
                                   "extensions/KHR_materials_clearcoat/clearcoatFactor",
                                   "extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor",
                                   "extensions/KHR_materials_sheen/sheenRoughnessFactor",
                                   "extensions/KHR_materials_anisotropy/anisotropyStrength",
                                   "extensions/KHR_materials_iridescence/iridescenceFactor"};

TEST(GltfBadValues, NumbersFromZeroToOne) {
    for (const char* field : Numbers) {
        expect_default({field, "-1", "outside 0 to 1"});
        expect_default({field, "1.5", "outside 0 to 1"});
        expect_default({field, "\"rough\"", "not a number"});
        expect_default({field, "null", "not a number"});
    }
}

TEST(GltfBadValues, NumbersThatAreNotValidJson) {
    for (const char* value : {"NaN", "-NaN", "Infinity", "-Infinity", "1e999", "nan"}) {
        expect_default({"pbrMetallicRoughness/roughnessFactor", value, "not a number"});
        expect_default(
            {"pbrMetallicRoughness/baseColorFactor", "[1," + std::string(value) + ",0,1]", "not 4 numbers"});
        expect_default({"emissiveFactor", "[0,0," + std::string(value) + "]", "not 3 numbers"});
    }
}

TEST(GltfBadValues, OtherNumbers) {
    expect_default({"extensions/KHR_materials_ior/ior", "0.2", "outside 1 to 100"});
    expect_default({"extensions/KHR_materials_ior/ior", "-1", "outside 1 to 100"});
    expect_default({"extensions/KHR_materials_iridescence/iridescenceIor", "0.2", "outside 1 to 100"});
    expect_default(
        {"extensions/KHR_materials_emissive_strength/emissiveStrength", "-2", "outside 0 to 1e+12"});
    expect_default({"extensions/KHR_materials_volume/thicknessFactor", "-1", "outside 0 to 1e+12"});
    expect_default({"extensions/KHR_materials_volume/attenuationDistance", "0", "outside 1e-12 to 1e+12"});
    expect_default(
        {"extensions/KHR_materials_iridescence/iridescenceThicknessMinimum", "-1", "outside 0 to 1e+12"});
    expect_default(
        {"extensions/KHR_materials_iridescence/iridescenceThicknessMaximum", "[]", "not a number"});
    expect_default(
        {"extensions/KHR_materials_anisotropy/anisotropyRotation", "1e9", "outside -1e+06 to 1e+06"});
    expect_default({"alphaCutoff", "-0.5", "outside 0 to 1e+12"});
}

TEST(GltfBadValues, Colors) {
    expect_default({"pbrMetallicRoughness/baseColorFactor", "[2,0,0,1]", "outside 0 to 1"});
    expect_default({"pbrMetallicRoughness/baseColorFactor", "[1,0,0]", "not 4 numbers"});
    expect_default({"pbrMetallicRoughness/baseColorFactor", "\"red\"", "not 4 numbers"});
    expect_default({"emissiveFactor", "[1,1]", "not 3 numbers"});
    expect_default({"emissiveFactor", "[-1,0,0]", "outside 0 to 1e+12"});
    expect_default({"extensions/KHR_materials_volume/attenuationColor", "[0,2,0]", "outside 0 to 1"});
    expect_default(
        {"extensions/KHR_materials_specular/specularColorFactor", "[0,-1,0]", "outside 0 to 1e+12"});
    expect_default({"extensions/KHR_materials_sheen/sheenColorFactor", "[0,0,1.1]", "outside 0 to 1"});
}

TEST(GltfBadValues, EnumeratorsFlagsAndObjects) {
    expect_default({"alphaMode", "\"GLASS\"", "none of OPAQUE, MASK and BLEND"});
    expect_default({"doubleSided", "1", "neither true nor false"});
    expect_default({"pbrMetallicRoughness", "[\"rough\"]", "not an object"});
    expect_default({"extensions", "7", "not an object"});
    expect_default({"extensions/KHR_materials_clearcoat", "7", "not an object"});
    expect_default({"extensions/KHR_materials_unlit", "true", "not an object"});
}

TEST(GltfBadValues, Textures) {
    for (const char* field :
         {"pbrMetallicRoughness/baseColorTexture", "pbrMetallicRoughness/metallicRoughnessTexture",
          "normalTexture", "emissiveTexture", "extensions/KHR_materials_transmission/transmissionTexture",
          "extensions/KHR_materials_specular/specularTexture",
          "extensions/KHR_materials_specular/specularColorTexture",
          "extensions/KHR_materials_clearcoat/clearcoatTexture",
          "extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture",
          "extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
          "extensions/KHR_materials_sheen/sheenColorTexture",
          "extensions/KHR_materials_sheen/sheenRoughnessTexture",
          "extensions/KHR_materials_anisotropy/anisotropyTexture",
          "extensions/KHR_materials_iridescence/iridescenceTexture",
          "extensions/KHR_materials_iridescence/iridescenceThicknessTexture"}) {
        expect_default({field, R"({"index":0.2})", "not an object with an integer index"});
        expect_default({field, R"({"index":-1})", "not an object with an integer index"});
        expect_default({field, "\"wood.png\"", "not an object with an integer index"});
    }
}

TEST(GltfBadValues, MembersOfATexture) {
    const auto read = [](const std::string& members) {
        return with_material(R"({"name":"paint","pbrMetallicRoughness":{"baseColorTexture":{"index":0,)" +
                             members + "}}}");
    };
    const std::string field = "material 'paint': pbrMetallicRoughness/baseColorTexture/";
    const ImportedScene transform = read(
        R"("texCoord":-1,"extensions":{"KHR_texture_transform":{"offset":[1],"scale":[1,"x"],"rotation":"90"}})");
    for (const char* wrong : {"texCoord is -1, not a non-negative integer",
                              "extensions/KHR_texture_transform/offset is [1], not 2 numbers",
                              "extensions/KHR_texture_transform/scale is [1,\"x\"], not 2 numbers",
                              "extensions/KHR_texture_transform/rotation is \"90\", not a number"}) {
        EXPECT_TRUE(has_notice(transform, field + wrong));
    }
    scene::TextureSlot slot = named<Material>(transform, "paint").base_color_texture;
    EXPECT_TRUE(slot.texture);
    slot.texture = {};
    EXPECT_EQ(slot, scene::TextureSlot{});
    EXPECT_TRUE(has_notice(read(R"("extensions":{"KHR_texture_transform":9})"),
                           "KHR_texture_transform is 9, not an object"));
}

TEST(GltfBadValues, ValidOnesNextToInvalidOnesAreKept) {
    const ImportedScene scene = with_material(
        R"({"name":"paint","pbrMetallicRoughness":{"baseColorFactor":[1],"roughnessFactor":0.25},
            "extras":{"is":[1.5,"NaN"]},"alphaMode":"BLEND"})");
    const Material& paint = named<Material>(scene, "paint");
    EXPECT_EQ(paint.base_color, glm::vec4(1.0f));
    EXPECT_EQ(paint.roughness, 0.25f);
    EXPECT_EQ(paint.alpha_mode, scene::AlphaMode::Blend);
}

// What the specification allows, and what programs write for 0 and 1 in single precision.
TEST(GltfBadValues, TheEndsOfTheRangesAreValid) {
    const ImportedScene scene = with_material(
        R"({"name":"paint","pbrMetallicRoughness":{"baseColorFactor":[1.00000012,0,-1e-8,1],"roughnessFactor":0},
            "emissiveFactor":[0,1,0],"alphaCutoff":2,"extensions":{"KHR_materials_ior":{"ior":0},
            "KHR_materials_specular":{"specularColorFactor":[3,1,1]}}})");
    const Material& paint = named<Material>(scene, "paint");
    EXPECT_EQ(paint.base_color, glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(paint.roughness, 0.0f);
    EXPECT_EQ(paint.index_of_refraction, 0.0f) << "KHR_materials_ior: everything is reflected";
    EXPECT_EQ(paint.alpha_cutoff, 2.0f);
    EXPECT_EQ(paint.specular_color.x, 3.0f);
    EXPECT_FALSE(has_notice(scene, "material 'paint'"));
}

TEST(GltfBadValues, BrightEmissiveFactorsAreUsedAndReported) {
    const ImportedScene scene = with_material(R"({"name":"lamp","emissiveFactor":[5,1,0]})");
    EXPECT_EQ(named<Material>(scene, "lamp").emission, glm::vec3(5, 1, 0));
    EXPECT_TRUE(has_notice(scene, "material 'lamp': emissiveFactor is [5,1,0], above 1"));
    EXPECT_TRUE(has_notice(scene, "export it as KHR_materials_emissive_strength"));
}

TEST(GltfBadValues, ManyGiveAShortList) {
    std::string wrong;
    SceneFile file;
    for (int i = 0; i < 500; ++i) file.add("materials", R"({"doubleSided":7})");
    file.add_triangle();
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.gltf", file.gltf()));
    EXPECT_LT(scene.notices.size(), 80u);
    EXPECT_TRUE(has_notice(scene, "material 3: doubleSided is 7"));
    EXPECT_TRUE(has_notice(scene, "436 other wrong values of materials"));
}

TEST(GltfBadValues, MaterialsThatAreNotObjects) {
    EXPECT_TRUE(has_notice(with_material("7"), "material 0: it is 7, not an object"));
}

TEST(GltfBadValues, TexturesWithoutAnImageNameTheirMaterials) {
    SceneFile file;
    file.add("images", R"({"uri":"lost.png"})");
    file.add("textures", R"({"source":0})");
    file.add("textures", "{}");
    file.add("materials", R"({"name":"a","normalTexture":{"index":0}})");
    file.add("materials", R"({"name":"b","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})");
    file.add("materials", R"({"name":"c","pbrMetallicRoughness":{"baseColorTexture":{"index":1}}})");
    file.add("materials", R"({"name":"d","pbrMetallicRoughness":{"baseColorTexture":{"index":9}}})");
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    std::string primitives;
    for (int i = 0; i < 4; ++i) {
        primitives += std::string(i == 0 ? "" : ",") + R"({"attributes":{"POSITION":)" + std::to_string(at) +
                      R"(},"material":)" + std::to_string(i) + "}";
    }
    file.add("meshes", R"({"primitives":[)" + primitives + "]}");
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.gltf", file.gltf()));
    expect_consistent(scene);
    EXPECT_TRUE(has_notice(scene, "there is no file 'lost.png' in the scene's folder"));
    EXPECT_TRUE(has_notice(scene,
                           "material 'a': texture 'lost.png' cannot be used (its file cannot be read: "
                           "put it into the scene's folder): only the factor is used"));
    EXPECT_TRUE(has_notice(scene, "material 'b': texture 'lost.png' cannot be used"));
    EXPECT_TRUE(has_notice(scene, "a magenta checkerboard replaces it"));
    EXPECT_TRUE(has_notice(scene, "material 'c': texture 1 cannot be used (it names no image"));
    EXPECT_TRUE(
        has_notice(scene, "material 'd': texture 9 cannot be used (the file has 2 textures: correct"));
}

TEST(GltfBadValues, ColoursOfVerticesAreClampedAsTheSpecificationSays) {
    SceneFile file;
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const auto mesh = [&](const char* name, const std::vector<glm::vec4>& colors) {
        const int color = file.accessor(file.view(colors), Component::Float, "VEC4", 3);
        return file.add("meshes", std::string(R"({"name":")") + name + R"(","primitives":[{"attributes":{)" +
                                      R"("POSITION":)" + std::to_string(at) + R"(,"COLOR_0":)" +
                                      std::to_string(color) + "}}]}");
    };
    const float infinity = std::numeric_limits<float>::infinity(),
                nan = std::numeric_limits<float>::quiet_NaN();
    mesh("bright", {{2, 0, 0, 1}, {-1, infinity, 0, 1}, {0.5f, 0, 0, 3}});
    mesh("odd", {{nan, 0, 0, 1}, {1, 0, 0, 1}, {0, 0, 0, 1}});
    for (int i = 0; i < 2; ++i) file.add("nodes", R"({"mesh":)" + std::to_string(i) + "}");
    file.add("scenes", R"({"nodes":[0,1]})");
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
    expect_valid(scene);
    EXPECT_TRUE(
        has_notice(scene, "mesh 'bright': vertex colours outside 0 to 1 are clamped, as glTF specifies"));
    EXPECT_THAT(values<glm::vec4>(scene, named<scene::Geometry>(scene, "bright").colors),
                testing::ElementsAre(glm::vec4(1, 0, 0, 1), glm::vec4(0, 1, 0, 1), glm::vec4(0.5f, 0, 0, 1)));
    EXPECT_TRUE(has_notice(scene, "mesh 'odd': vertex colours"));
    EXPECT_TRUE(named<scene::Geometry>(scene, "odd").colors.empty());
}

}  // namespace
}  // namespace tessera::import
