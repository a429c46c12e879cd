#include <gmock/gmock.h>

#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

// Damaged pictures, and pictures that claim more than their bytes can hold.
namespace tessera::import {
namespace {

constexpr const char* TexturedObj =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";

// 16 x 2 pixels of the radiance (2, 1, 0.5), as runs.
std::string radiance_picture() {
    std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 16\n";
    for (int row = 0; row < 2; ++row) {
        bytes += std::string("\2\2\0\x10", 4);
        for (const char value : {'\x80', '\x40', '\x20', '\x82'}) bytes += {'\x90', value};
    }
    return bytes;
}

ImportedScene with_texture(const TestFolder& folder, const std::string& name, const std::string& bytes) {
    folder.write(name, bytes);
    folder.write("a.mtl", "newmtl m\nKd 1 1 1\nmap_Kd " + name + "\n");
    return loaded(folder.write("a.obj", TexturedObj));
}

Expected<ImportedScene> with_environment(const TestFolder& folder, const std::string& name,
                                         const std::string& bytes) {
    ImportOptions options;
    options.environment = folder.write(name, bytes);
    return import_scene(folder.write("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), options);
}

TEST(ImageLimits, EveryTruncationOfARadianceEnvironmentIsAnErrorThatNamesIt) {
    const TestFolder folder;
    const std::string whole = radiance_picture();
    EXPECT_TRUE(with_environment(folder, "sky.hdr", whole));
    for (std::size_t length = 0; length < whole.size(); ++length) {
        SCOPED_TRACE(length);
        const auto scene = with_environment(folder, "sky.hdr", whole.substr(0, length));
        ASSERT_FALSE(scene);
        EXPECT_EQ(scene.error().code(), ErrorCode::InvalidInput);
        EXPECT_THAT(scene.error().what(), testing::HasSubstr("sky.hdr"));
        EXPECT_THAT(scene.error().what(), testing::HasSubstr("write it again"));
    }
}

TEST(ImageLimits, ARadianceTextureBecomesSrgb) {
    const TestFolder folder;
    const ImportedScene scene = with_texture(folder, "t.hdr", radiance_picture());
    expect_consistent(scene);
    EXPECT_EQ(scene.counts.placeholders, 0u);
    const scene::Texture& texture = named<scene::Texture>(scene, "t.hdr");
    EXPECT_EQ(texture.width, 16u);
    EXPECT_EQ(texture.height, 2u);
    const auto texels = values<glm::u8vec4>(scene, texture.texels);
    ASSERT_EQ(texels.size(), 32u);
    EXPECT_EQ(texels[31], glm::u8vec4(255, 255, 188, 255));
}

TEST(ImageLimits, ATruncatedRadianceTextureIsAPlaceholder) {
    const TestFolder folder;
    const std::string whole = radiance_picture();
    const ImportedScene scene = with_texture(folder, "t.hdr", whole.substr(0, whole.size() - 1));
    EXPECT_EQ(scene.counts.placeholders, 1u);
    EXPECT_TRUE(has_notice(scene, "'t.hdr' cannot be used (it ends in the middle of its pixels"));
}

}  // namespace
}  // namespace tessera::import
