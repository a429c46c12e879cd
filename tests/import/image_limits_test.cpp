#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gmock/gmock.h>

#include "client/import/image_decoder.h"
#include "client/import/jpeg_check.h"
#include "mediator/picture/exr_header.h"
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

template <class T>
void append(std::string& bytes, T value) {  // little-endian
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_attribute(std::string& bytes, const char* name, const char* type, const std::string& value) {
    bytes.append(name).append(1, '\0').append(type).append(1, '\0');
    append(bytes, static_cast<std::int32_t>(value.size()));
    bytes += value;
}

// Of an OpenEXR file with three half floats per pixel, and no pixels.
std::string exr_header(std::int32_t width, std::int32_t height, char compression, std::int32_t tile = 0) {
    std::string bytes;
    append(bytes, std::uint32_t{20000630});
    append(bytes, std::uint32_t{tile > 0 ? 0x202u : 2u});
    std::string channels, window, tiles;
    for (const char* name : {"B", "G", "R"}) {
        channels.append(name).append(1, '\0');
        for (const std::int32_t value : {1, 0, 1, 1}) append(channels, value);
    }
    channels += '\0';
    for (const std::int32_t value : {0, 0, width - 1, height - 1}) append(window, value);
    append_attribute(bytes, "channels", "chlist", channels);
    append_attribute(bytes, "compression", "compression", {compression});
    append_attribute(bytes, "dataWindow", "box2i", window);
    append_attribute(bytes, "displayWindow", "box2i", window);
    append_attribute(bytes, "lineOrder", "lineOrder", std::string(1, '\0'));
    append_attribute(bytes, "pixelAspectRatio", "float", std::string("\0\0\x80\x3f", 4));
    append_attribute(bytes, "screenWindowCenter", "v2f", std::string(8, '\0'));
    append_attribute(bytes, "screenWindowWidth", "float", std::string("\0\0\x80\x3f", 4));
    for (int i = 0; i < 2; ++i) append(tiles, tile);
    if (tile > 0) append_attribute(bytes, "tiles", "tiledesc", tiles + '\0');
    return bytes + '\0';
}

std::string cause_of_refusal(const std::string& exr) {
    const TestFolder folder;
    const auto scene = with_environment(folder, "sky.exr", exr);
    EXPECT_FALSE(scene);
    if (scene) return "";
    EXPECT_EQ(scene.error().code(), ErrorCode::InvalidInput);
    EXPECT_THAT(scene.error().what(), testing::HasSubstr("sky.exr"));
    return scene.error().what();
}

TEST(ImageLimits, ASmallExrFileCannotClaimALargePicture) {
    constexpr char None = 0, Zip = 3, Dwab = 9, Unknown = 10;
    for (char compression = None; compression <= Dwab; ++compression) {
        SCOPED_TRACE(int{compression});
        EXPECT_THAT(cause_of_refusal(exr_header(16384, 8192, compression)), testing::HasSubstr("has only"));
        EXPECT_THAT(cause_of_refusal(exr_header(16384, 8192, compression, 64)),
                    testing::HasSubstr("has only"));
    }
    EXPECT_THAT(cause_of_refusal(exr_header(64, 64, None)), testing::HasSubstr("has only"));
    EXPECT_THAT(cause_of_refusal(exr_header(16384, 16384, Zip)), testing::HasSubstr("more than the"));
    EXPECT_THAT(cause_of_refusal(exr_header(8, 8, Zip, 1 << 13)), testing::HasSubstr("tiles are too large"));
    EXPECT_THAT(cause_of_refusal(exr_header(8, 8, Unknown)), testing::HasSubstr("compression is unknown"));
}

TEST(ImageLimits, ConstantExrPicturesAreNotRefused) {
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "grey.exr";
    for (const Imf::Compression compression :
         {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
          Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION, Imf::B44A_COMPRESSION,
          Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION}) {
        for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT}) {
            SCOPED_TRACE(std::to_string(compression) + " " + std::to_string(type));
            constexpr int Width = 1024, Height = 512;
            Imf::Header header(Width, Height);
            header.compression() = compression;
            Imf::FrameBuffer pixels;
            std::vector<char> black(Width * sizeof(float));
            for (const char* name : {"R", "G", "B"}) {
                header.channels().insert(name, Imf::Channel(type));
                pixels.insert(name, Imf::Slice(type, black.data(), sizeof(float), 0));
            }
            Imf::OutputFile output(file.c_str(), header, 0);
            output.setFrameBuffer(pixels);
            output.writePixels(Height);
        }
        EXPECT_NO_THROW(picture::checked_exr_window(file.string()));
    }
}

TEST(ImageLimits, APngCannotClaimMoreThanItsBytesHold) {
    std::string bytes = png(1, 1, {1, 2, 3, 4});
    const auto image = decode_image({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
    ASSERT_TRUE(image) << image.error().what();
    EXPECT_THAT(image->rgba, testing::ElementsAre(1, 2, 3, 4));
    bytes = png(2, 2, {1, 2, 3, 4}, 12000, 10000);
    bytes.resize(bytes.size() + 300'000);  // enough for a bit per pixel, but not for 32
    const auto refused = decode_image({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what(), testing::HasSubstr("but has only"));
}

std::string text(std::initializer_list<int> values) {
    std::string bytes;
    for (const int value : values) bytes += static_cast<char>(value);
    return bytes;
}

// A Huffman table without codes: 0x00 to 0x03 for DC, 0x10 to 0x13 for AC.
std::string empty_table(int number) {
    return text({0xff, 0xc4, 0, 19, number}) + std::string(16, '\0');
}

// A progressive JPEG of one component with one empty table, with as many scans, and some bytes of data.
std::string jpeg(int width, int height, int scans, std::size_t data) {
    std::string bytes = text({0xff, 0xd8, 0xff, 0xc2, 0, 11, 8, height >> 8, height & 255, width >> 8,
                              width & 255, 1, 1, 0x11, 0}) +
                        empty_table(0);
    for (int i = 0; i < scans; ++i) bytes += text({0xff, 0xda, 0, 8, 1, 1, 0, 0, 0, 0});
    return bytes + std::string(data, '\x55') + "\xff\xd9";
}

std::string refusal_of(const std::string& bytes) {
    const auto checked = check_jpeg({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
    return checked ? "" : checked.error().what();
}

TEST(ImageLimits, AJpegCannotClaimMoreThanItsBytesHold) {
    EXPECT_THAT(refusal_of(jpeg(16384, 8192, 1, 100'000)), testing::HasSubstr("has only"));
    EXPECT_EQ(refusal_of(jpeg(16384, 8192, 1, 300'000)), "");
    EXPECT_THAT(refusal_of(jpeg(16384, 8193, 1, 300'000)), testing::HasSubstr("more than the"));
    EXPECT_THAT(refusal_of(jpeg(16384, 8192, 17, 300'000)), testing::HasSubstr("17 scans"));
    EXPECT_THAT(refusal_of(jpeg(8, 8, 501, 0)), testing::HasSubstr("501 scans"));
    EXPECT_EQ(refusal_of(jpeg(8, 8, 500, 0)), "");
    std::string tables("\xff\xd8\xff\xc4\0\x15\0", 7);
    tables += std::string(14, '\0') + "\xff\2" + std::string(257, '\1');
    tables += jpeg(8, 8, 1, 0).substr(2);
    for (const std::string& bytes : {tables, "\xff" + tables}) {  // the second with a fill byte
        const auto image = decode_image({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
        ASSERT_FALSE(image);
        EXPECT_THAT(image.error().what(), testing::HasSubstr("257 codes"));
    }
    // The segment claims more than the file has; stb_image reads the table all the same.
    const std::string cut = std::string("\xff\xd8\xff\xc4\xff\xff\0", 7) + std::string(16, '\xff');
    EXPECT_THAT(refusal_of(cut), testing::HasSubstr("4080 codes"));
    const std::string large = jpeg(16384, 8192, 0, 0), small = jpeg(8, 8, 1, 0);
    EXPECT_THAT(refusal_of(large.substr(0, large.size() - 2) + small.substr(2)),
                testing::HasSubstr("has only"));
}

// stb_image decodes with uninitialised memory in place of a table that is missing.
TEST(ImageLimits, AJpegNeedsTheTablesOfItsScans) {
    const auto baseline = [](const std::string& tables, int numbers) {
        return text({0xff, 0xd8, 0xff, 0xc0, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0}) + tables +
               text({0xff, 0xda, 0, 8, 1, 1, numbers, 0, 63, 0, 0x55, 0x55, 0xff, 0xd9});
    };
    const std::string both = empty_table(0x01) + empty_table(0x12);
    EXPECT_EQ(refusal_of(baseline(both, 0x12)), "");
    for (const int numbers : {0x02, 0x11, 0x32})
        EXPECT_THAT(refusal_of(baseline(both, numbers)), testing::HasSubstr("lacks a Huffman table"));
    EXPECT_THAT(refusal_of(baseline("", 0)), testing::HasSubstr("lacks a Huffman table"));
    const auto progressive = [](int frequency, int bits) {
        return text({0xff, 0xd8, 0xff, 0xc2, 0, 11, 8, 0, 8,         0,         8,    1,    1,    0x11,
                     0,    0xff, 0xda, 0,    8, 1,  1, 0, frequency, frequency, bits, 0x55, 0xff, 0xd9});
    };
    EXPECT_THAT(refusal_of(progressive(0, 0)), testing::HasSubstr("lacks a Huffman table"));
    EXPECT_EQ(refusal_of(progressive(0, 0x10)), "");  // a refinement of DC
    EXPECT_THAT(refusal_of(progressive(1, 0x10)), testing::HasSubstr("lacks a Huffman table"));
}

}  // namespace
}  // namespace tessera::import
