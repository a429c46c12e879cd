// Files of calibration tools: PFM, PNG weights and warp meshes, valid and malformed.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "client/display_file/mesh_file.h"
#include "client/display_file/pfm.h"
#include "mediator/base/random.h"
#include "mediator/picture/png_reader.h"
#include "mediator/picture/png_writer.h"

namespace tessera::display_file {
namespace {

constexpr float NoValue = std::numeric_limits<float>::quiet_NaN();

std::vector<std::byte> pfm_bytes(const std::string& header, const std::vector<float>& values,
                                 bool is_big_endian = false) {
    std::vector<std::byte> bytes(header.size() + 4 * values.size());
    std::memcpy(bytes.data(), header.data(), header.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        auto bits = std::bit_cast<std::uint32_t>(values[i]);
        if (is_big_endian) bits = __builtin_bswap32(bits);
        std::memcpy(bytes.data() + header.size() + 4 * i, &bits, 4);
    }
    return bytes;
}

std::string error_of(const auto& loaded) {
    return loaded ? "" : loaded.error().what();
}

TEST(Pfm, ReadsBothByteOrdersAndNaN) {
    const std::vector<float> values{1, 2, 3, NoValue, NoValue, NoValue};
    for (const bool is_big : {false, true}) {
        const auto grid =
            parse_pfm(pfm_bytes(is_big ? "PF\n2 1\n1.0\n" : "PF\n2 1\n-1.0\n", values, is_big), "a.pfm");
        ASSERT_TRUE(grid) << error_of(grid);
        EXPECT_EQ(grid->columns, 2u);
        EXPECT_EQ(grid->rows, 1u);
        EXPECT_EQ(grid->components, 3u);
        EXPECT_EQ(grid->values[1], 2.0f);
        EXPECT_TRUE(std::isnan(grid->values[4]));
    }
    const auto grey = parse_pfm(pfm_bytes("Pf 3 2 -1\n", {1, 2, 3, 4, 5, 6}), "b.pfm");
    ASSERT_TRUE(grey) << error_of(grey);
    EXPECT_EQ(grey->rows, 2u);
    EXPECT_EQ(grey->values[3], 4.0f);
}

TEST(Pfm, ErrorsNameTheCause) {
    const auto refused = [](const std::vector<std::byte>& bytes) {
        return error_of(parse_pfm(bytes, "w.pfm"));
    };
    EXPECT_NE(refused(pfm_bytes("P6\n2 1\n-1\n", {1, 2})).find("w.pfm: is not a PFM"), std::string::npos);
    EXPECT_NE(refused(pfm_bytes("Pf\n2 1\n0\n", {1, 2})).find("scale"), std::string::npos);
    EXPECT_NE(refused(pfm_bytes("Pf\n2 2\n-1\n", {1, 2})).find("8 bytes of values instead of 16"),
              std::string::npos);
    EXPECT_NE(refused(pfm_bytes("Pf\n2 1\n-1\n", {1, 2, 3})).find("instead of 8"), std::string::npos);
    EXPECT_NE(refused(pfm_bytes("Pf\n0 1\n-1\n", {})).find("0 x 1 nodes"), std::string::npos);
    EXPECT_NE(refused(pfm_bytes("Pf\n70000 70000\n-1\n", {})).find("16384"), std::string::npos);
    EXPECT_NE(refused(pfm_bytes("Pf\n2 1\n-1\n", {1, INFINITY})).find("column 1, row 0"), std::string::npos);
    EXPECT_NE(refused(pfm_bytes("Pf\n1 1\n-1\n", {NoValue})).find("only NaN"), std::string::npos);
    EXPECT_NE(refused({}), "");
    EXPECT_EQ(load_pfm("/no/such.pfm").error().code(), ErrorCode::NotFound);
}

TEST(Weights, PngAndPfmInLinearLight) {
    const std::vector<std::uint8_t> rgb{0, 0, 0, 128, 128, 128, 255, 255, 255, 51, 51, 51};
    const auto weights = parse_weights(picture::encode_png(2, 2, rgb), "a.png", 2.2);
    ASSERT_TRUE(weights) << error_of(weights);
    EXPECT_EQ(weights->components, 1u);
    EXPECT_NEAR(weights->values[1], std::pow(128.0 / 255.0, 2.2), 1e-6);
    EXPECT_EQ(weights->values[2], 1.0f);
    EXPECT_TRUE(parse_weights(pfm_bytes("Pf\n1 1\n-1\n", {0.5f}), "a.pfm", 2.2));
    EXPECT_NE(
        error_of(parse_weights(pfm_bytes("Pf\n2 1\n-1\n", {0.5f, 1.5f}), "a.pfm", 1.0)).find("column 1"),
        std::string::npos);
    EXPECT_NE(
        error_of(parse_weights(pfm_bytes("Pf\n2 1\n-1\n", {NoValue, 1}), "a.pfm", 1.0)).find("column 0"),
        std::string::npos);
    EXPECT_NE(error_of(parse_weights({}, "a.pfm", 1.0)).find("not a PNG"), std::string::npos);
}

TEST(Mesh, NodesBecomePixelsAndRowsGoFromTheTop) {
    // The middle half of the source, darker to the right.
    const std::string text =
        "2\n2 2\n-2 -1 0.25 0.25 1\n2 -1 0.75 0.25 0.5\n-2 1 0.25 0.75 1\n2 1 0.75 0.75 0.5\n";
    const auto mesh = parse_mesh(text, "m.data", 8, 4);
    ASSERT_TRUE(mesh) << error_of(mesh);
    for (std::uint32_t y = 0; y < 4; ++y)
        for (std::uint32_t x = 0; x < 8; ++x) {
            const std::size_t pixel = y * 8 + x;
            EXPECT_NEAR(mesh->source_uv.values[2 * pixel], 0.25 + 0.5 * (x + 0.5) / 8, 1e-6);
            EXPECT_NEAR(mesh->source_uv.values[2 * pixel + 1], 0.25 + 0.5 * (y + 0.5) / 4, 1e-6);
            EXPECT_NEAR(mesh->weights.values[pixel], 1.0 - 0.5 * (x + 0.5) / 8, 1e-6);
        }
}

TEST(Mesh, CellsAroundUnusedNodesAreNotShown) {
    std::string text = "2\n3 2\n";
    for (const int y : {-1, 1})
        for (const int x : {-1, 0, 1})
            text += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string((x + 1) / 2.0) + " " +
                    std::to_string((y + 1) / 2.0) + (x == 1 && y == 1 ? " -1\n" : " 1\n");
    const auto mesh = parse_mesh(text, "m.data", 10, 10);
    ASSERT_TRUE(mesh) << error_of(mesh);
    for (std::size_t pixel = 0; pixel < 100; ++pixel) {
        EXPECT_EQ(std::isnan(mesh->source_uv.values[2 * pixel]), pixel % 10 >= 5);
        EXPECT_EQ(mesh->weights.values[pixel], pixel % 10 >= 5 ? 0.0f : 1.0f);
    }
}

TEST(Mesh, ErrorsNameTheLine) {
    const auto refused = [](const std::string& text) { return error_of(parse_mesh(text, "m.data", 4, 4)); };
    EXPECT_NE(refused("two\n").find("m.data:1: "), std::string::npos);
    EXPECT_NE(refused("2\n2\n").find("m.data:2: "), std::string::npos);
    EXPECT_NE(refused("2\n4000 4000\n0 0 0 0 1\n").find("more nodes than"), std::string::npos);
    const std::string node = "0.123 0.5 0.5 0.5 1\n";
    EXPECT_NE(refused("2\n2 2\n" + node + node + "0 0 0 0\n").find("m.data:5: "), std::string::npos);
    EXPECT_NE(refused("2\n2 2\n" + node + node + "0 0 nan 0 1\n").find("m.data:5: "), std::string::npos);
    EXPECT_NE(refused("2\n2 2\n" + node + node + node + node + node).find("more lines"), std::string::npos);
}

// Any bytes give a value or an error.
TEST(CalibrationFiles, DamagedFilesAreReadOrRejected) {
    CounterRandom random(5);
    const std::string mesh = "2\n2 2\n-1 -1 0 0 1\n1 -1 1 0 1\n-1 1 0 1 1\n1 1 1 1 1\n";
    std::vector<std::vector<std::byte>> seeds{pfm_bytes("PF\n2 1\n-1.0\n", {1, 2, 3, 4, 5, 6}),
                                              picture::encode_png(4, 4, std::vector<std::uint8_t>(48, 77))};
    seeds.emplace_back(mesh.size());
    std::memcpy(seeds.back().data(), mesh.data(), mesh.size());
    int read = 0, refused = 0;
    for (int round = 0; round < 6000; ++round) {
        std::vector<std::byte> bytes = seeds[static_cast<std::size_t>(round) % seeds.size()];
        if (round % 4 == 0) bytes.resize(std::size_t(random.uniform() * double(bytes.size())));
        const int flips = round % 4 == 1 ? 0 : 1 + round % 5;
        for (int i = 0; i < flips && !bytes.empty(); ++i)
            bytes[std::size_t(random.uniform() * double(bytes.size()))] ^= std::byte(1u << (round % 8));
        const auto grid = parse_pfm(bytes, "x");
        const auto weights = parse_weights(bytes, "x", 1.0);
        const auto nodes = parse_mesh({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "x", 8, 8);
        const auto image = picture::read_png(bytes);
        read += grid || weights || nodes || image;
        refused += !grid && !weights && !nodes && !image;
    }
    EXPECT_GT(read, 100);
    EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace tessera::display_file
