// glTF extensions: supported, ignored, listed.
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

namespace tessera::import {
namespace {

TEST(GltfExtensions, AnUnknownOptionalExtensionIsNoticed) {
    SceneFile file;
    file.add_triangle();
    file.set("extensionsUsed", R"(["ACME_rockets"])");
    const TestFolder folder;
    EXPECT_TRUE(
        has_notice(loaded(folder.write("scene.glb", file.glb())), "extension ACME_rockets is ignored"));
}

TEST(GltfExtensions, VariantsAreListedWhateverTheyAre) {
    const TestFolder folder;
    const auto variants = [&](const std::string& extension) {
        SceneFile file;
        file.add_triangle();
        file.set("extensionsUsed", R"(["KHR_materials_variants","KHR_materials_ior"])");
        file.set("extensions", R"({"KHR_materials_variants":)" + extension + "}");
        const ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
        EXPECT_EQ(scene.extensions,
                  (std::vector<std::string>{"KHR_materials_variants", "KHR_materials_ior"}));
        return scene.variants;
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(variants(R"({"variants":[{"name":"red"},{"name":"blue"}]})"), (Names{"red", "blue"}));
    EXPECT_EQ(variants(R"({"variants":[{"name":7},{"name":"blue"}]})"), (Names{"", "blue"}));
    for (const char* nothing : {"{}", R"({"variants":7})", R"({"variants":{"name":"red"}})"})
        EXPECT_EQ(variants(nothing), Names{}) << nothing;
}

}  // namespace
}  // namespace tessera::import
