// MPCDI archives of calibration tools: parsing, conversion to display files, and errors.
#include "client/display_file/mpcdi.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "client/display_file/display_file.h"
#include "client/display_file/mpcdi_import.h"
#include "mediator/base/random.h"
#include "mediator/display/projector.h"
#include "mediator/picture/png_writer.h"
#include "mediator/scene/blob.h"
#include "tests/display/mpcdi_archive.h"

namespace tessera::display_file {
namespace {

using namespace test;

constexpr float NoPoint = std::numeric_limits<float>::quiet_NaN();

constexpr const char* Warp =
    "<geometryWarpFile><path>w.pfm</path><interpolation>linear</interpolation></geometryWarpFile>\n";

constexpr const char* Frustum =
    "<frustum><yaw>30</yaw><pitch>0</pitch><roll>0</roll><rightAngle>20</rightAngle><leftAngle>-20</"
    "leftAngle>"
    "<upAngle>15</upAngle><downAngle>-15</downAngle></frustum>";

// Surveyors' axes: x right, y forward, z up.
constexpr const char* Frame =
    "<coordinateFrame><posx>1</posx><posy>-2</posy><posz>3</posz><yawx>0</yawx><yawy>0</yawy><yawz>-1</yawz>"
    "<pitchx>1</pitchx><pitchy>0</pitchy><pitchz>0</pitchz><rollx>0</rollx><rolly>1</rolly><rollz>0</rollz>"
    "</coordinateFrame>";

std::string text_of(const std::vector<std::uint8_t>& grey) {
    std::vector<std::uint8_t> rgb;
    for (const std::uint8_t value : grey) rgb.insert(rgb.end(), 3, value);
    const auto png = picture::encode_png(static_cast<std::uint32_t>(grey.size()), 1, rgb);
    return {reinterpret_cast<const char*>(png.data()), png.size()};
}

Mpcdi parsed(const Entries& entries) {
    const auto bytes = zipped(entries);
    auto mpcdi = parse_mpcdi(bytes, "a.mpcdi");
    if (!mpcdi) throw mpcdi.error();
    return std::move(*mpcdi);
}

std::string archive_error(const Entries& entries) {
    const auto bytes = zipped(entries);
    const auto mpcdi = parse_mpcdi(bytes, "a.mpcdi");
    return mpcdi ? "" : mpcdi.error().what();
}

// Imports an archive into a folder and reads the resulting display file.
class ImportTest : public testing::Test {
  protected:
    ImportTest() {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() / (std::string("tessera-mpcdi-") + test->name());
        std::filesystem::create_directories(folder_);
    }
    ~ImportTest() override { std::filesystem::remove_all(folder_); }

    DisplayFile imported(const Entries& entries) {
        const ImportedDisplay display = import_mpcdi(parsed(entries), "wall");
        for (const auto& file : display.files)
            std::ofstream(folder_ / file.name, std::ios::binary)
                .write(reinterpret_cast<const char*>(file.content.data()),
                       static_cast<std::streamsize>(file.content.size()));
        notices_ = display.notices;
        return parse_display(display.text, (folder_ / "wall.toml").string(), blobs_);
    }

    std::filesystem::path folder_;
    scene::BlobStore blobs_;
    std::vector<std::string> notices_;
};

void expect_near(const glm::dvec3& value, const glm::dvec3& expected) {
    EXPECT_NEAR(value.x, expected.x, 1e-5);
    EXPECT_NEAR(value.y, expected.y, 1e-5);
    EXPECT_NEAR(value.z, expected.z, 1e-5);
}

TEST(Mpcdi, ReadsRegionsFrustaAndFrames) {
    const Mpcdi mpcdi =
        parsed({{"mpcdi.xml", xml("sl", region("Projector 1", std::string(Frustum) + Frame), "")}});
    ASSERT_EQ(mpcdi.regions.size(), 1u);
    const MpcdiRegion& found = mpcdi.regions[0];
    EXPECT_EQ(mpcdi.profile, MpcdiProfile::ShaderLamps);
    EXPECT_EQ(found.id, "Projector 1");
    EXPECT_EQ(found.width, 40u);
    EXPECT_EQ(found.buffer_width, 3000u);
    EXPECT_NEAR(found.frustum->yaw, 0.5235988, 1e-6);
    EXPECT_NEAR(found.frustum->down, -0.2617994, 1e-6);
    expect_near(found.frame->up, {0, 0, 1});
    expect_near(found.frame->forward, {0, 1, 0});
}

TEST(Mpcdi, ReadsTextWithoutFileReferences) {
    const auto read = [](const std::string& text) {
        return parse_mpcdi(std::as_bytes(std::span(text)), "a.mpcdi.xml");
    };
    const auto alone = read(xml("sl", region("p", std::string(Frustum) + Frame), ""));
    ASSERT_TRUE(alone) << alone.error().what();
    EXPECT_EQ(alone->regions[0].id, "p");
    const auto with_files = read(xml("a3", region("p"), files("p", Warp)));
    ASSERT_FALSE(with_files);
    EXPECT_NE(std::string(with_files.error().what()).find("'w.pfm', but is not in an archive"),
              std::string::npos);
}

TEST(Mpcdi, ConvertsWeightGammaAndLengthUnits) {
    const std::string points = pfm(2, 1, {100, 50, -200, 0, 0, 0});
    const std::string sets =
        files("r",
              "<geometryWarpFile><geometricUnit>cm</geometricUnit><path>w.pfm</path>"
              "</geometryWarpFile><alphaMap><gammaEmbedded>2.2</gammaEmbedded><path>a.png</path>"
              "</alphaMap><betaMap><path>b.png</path></betaMap>");
    const Mpcdi mpcdi = parsed({{"mpcdi.xml", xml("a3", region("r"), sets)},
                                {"w.pfm", points},
                                {"a.png", text_of({0, 128, 255})},
                                {"b.png", text_of({51})}});
    const MpcdiRegion& found = mpcdi.regions[0];
    EXPECT_NEAR(found.warp.values[0], 1.0f, 1e-6);
    EXPECT_NEAR(found.warp.values[2], -2.0f, 1e-6);
    EXPECT_TRUE(std::isnan(found.warp.values[3])) << "0, 0, 0 is nowhere";
    EXPECT_NEAR(found.weights.values[1], std::pow(128 / 255.0, 2.2), 1e-6);
    EXPECT_NEAR(found.lift.values[0], 0.2, 1e-6);
}

TEST_F(ImportTest, FlatRegionsMapToTheirPartOfTheBuffer) {
    const std::string left = region("l", "", "x=\"0\" y=\"0\" xsize=\"0.6\" ysize=\"1\"");
    const std::string right = region("r", "", "x=\"0.4\" y=\"0\" xsize=\"0.6\" ysize=\"1\"");
    std::vector<float> warp;  // the left region is upside down
    for (const float v : {0.75f, 0.25f})
        for (const float u : {0.25f, 0.75f}) warp.insert(warp.end(), {u, v, 0.0f});
    const DisplayFile file =
        imported({{"mpcdi.xml", xml("2d", left + right, files("l", Warp))}, {"w.pfm", pfm(2, 2, warp)}});
    ASSERT_EQ(file.display.outputs.size(), 2u);
    EXPECT_EQ(file.display.outputs[0].name, "l");
    EXPECT_EQ(file.geometry[0].screen, file.geometry[1].screen);
    // The screen is 2 m x 2/3 m, 2 m away. Nodes are at quarters of the region.
    expect_near(file.geometry[0].points.at(0, 0), {-1 + 2 * 0.25 * 0.6, 1 / 3.0 - 2 / 3.0 * 0.75, -2});
    expect_near(file.geometry[1].points.at(1, 0),
                {-1 + 2 * (0.4 + 0.75 * 0.6), 1 / 3.0 - 2 / 3.0 * 0.25, -2});
    ASSERT_EQ(notices_.size(), 1u);
    EXPECT_NE(notices_[0].find("measure"), std::string::npos);
}

TEST_F(ImportTest, FrustumBecomesScreenAlongItsAxis) {
    const DisplayFile file = imported({{"mpcdi.xml", xml("3d", region("f", Frustum), "")}});
    const auto& points = file.geometry[0].points;
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& point : points.points) middle += point / 4.0;
    expect_near(middle, {2 * std::sin(0.5235988), 0, -2 * std::cos(0.5235988)});  // 30 degrees to the right
    EXPECT_NEAR(glm::length(points.at(1, 0) - points.at(0, 0)), 2 * std::tan(0.3490659), 1e-6)
        << "half of the width";
    EXPECT_GT(points.at(0, 0).y, points.at(0, 1).y);
}

TEST_F(ImportTest, PointsInSpaceAreUnchanged) {
    const std::string points = pfm(2, 2, {-1, 1, -3, 1, 1, -3, -1, -1, -3, 1, -1, -3});
    const DisplayFile file =
        imported({{"mpcdi.xml", xml("a3", region("p"), files("p", Warp))}, {"w.pfm", points}});
    expect_near(file.geometry[0].points.at(1, 0), {1, 1, -3});
    EXPECT_FALSE(file.display.outputs[0].points.empty());
}

TEST_F(ImportTest, ShaderLampsBecomeProjectorsInDisplayAxes) {
    const std::string lamp = std::string(Frustum).replace(std::string(Frustum).find("30"), 2, "0") + Frame;
    const std::string moved = std::string(lamp).replace(lamp.find("<posy>-2"), 8, "<posy>1");
    const DisplayFile file = imported({{"mpcdi.xml", xml("sl", region("p", moved), "")}});
    ASSERT_TRUE(file.geometry[0].projector);
    const view::CameraPose& projector = *file.geometry[0].projector;
    expect_near(glm::dvec3(projector.world_from_camera[3]), {1, 3, -1});
    expect_near(glm::dvec3(projector.world_from_camera[2]), {0, 0, 1});
    EXPECT_NEAR(projector.right, std::tan(0.3490659), 1e-6);

    const std::string given = imported({{"mpcdi.xml", xml("sl", region("q", Frame), files("q", Warp))},
                                        {"w.pfm", pfm(2, 2, {-1, 3, 1, 1, 3, 1, -1, 3, -1, 1, 3, -1})}})
                                  .display.outputs[0]
                                  .name;
    EXPECT_EQ(given, "q");
}

TEST(MpcdiErrors, NameFileLineAndRemedy) {
    const auto about = [](const Entries& entries, const std::string& words) {
        const std::string message = archive_error(entries);
        EXPECT_NE(message.find(words), std::string::npos) << message;
        EXPECT_EQ(message.find("a.mpcdi"), 0u) << message;
    };
    about({{"other.xml", ""}}, "'mpcdi.xml' is not in the archive");
    about({{"mpcdi.xml", "<MPCDI profile=\"2d\">\n<display>\n</MPCDI>"}},
          "mpcdi.xml:3: the XML is malformed");
    about({{"mpcdi.xml", ""}}, "the XML is malformed");
    about({{"mpcdi.xml", "<html/>"}}, "has the root element <html>, not <MPCDI>");
    about({{"mpcdi.xml", xml("4d", region("r"), "")}}, "mpcdi.xml:2: the profile '4d'");
    about({{"mpcdi.xml", xml("2d", "", "")}}, "has no regions");
    about({{"mpcdi.xml", xml("2d", "<region id=\"r\"/>\n", "")}},
          "mpcdi.xml:5: <region> needs 'xResolution'");
    about({{"mpcdi.xml", xml("2d", region("r", "", "xsize=\"0\""), "")}}, "has no size");
    about({{"mpcdi.xml", xml("2d", region("r", "", "x=\"left\""), "")}}, "'x' must be a number, not 'left'");
    about({{"mpcdi.xml", xml("2d", region("r") + region("r"), "")}}, "mpcdi.xml:6: two regions");
    about({{"mpcdi.xml", xml("3d", region("r"), "")}}, "needs a <frustum>");
    about({{"mpcdi.xml", xml("a3", region("r"), "")}}, "needs a <geometryWarpFile>");
    about({{"mpcdi.xml", xml("sl", region("r", Frustum), "")}}, "<coordinateFrame>");
    about({{"mpcdi.xml", xml("2d", region("r"), files("s", Warp))}}, "region 's', which does not exist");
    about({{"mpcdi.xml", xml("2d", region("r"), files("r", Warp))}}, "'w.pfm' is not in the archive");
    about({{"mpcdi.xml", xml("2d", region("r"), files("r", Warp))}, {"w.pfm", "PF\n9 9\n-1\n"}},
          "0 bytes of values instead of 972");
    about({{"mpcdi.xml", xml("2d", region("r"), files("r", "<alphaMap><path>a.png</path></alphaMap>"))},
           {"a.png", "nothing"}},
          "not a PNG");
    const std::string flat = std::string(Frustum).replace(std::string(Frustum).find("-20"), 3, "20");
    about({{"mpcdi.xml", xml("3d", region("r", flat), "")}}, "the frustum is empty");
}

TEST(MpcdiErrors, RejectsPathTraversalAndZipBombs) {
    const std::string text = xml("2d", region("r"), "");
    for (const char* name : {"../evil", "a/../../evil", "/etc/evil", "C:evil", "a\\..\\evil"})
        EXPECT_NE(archive_error({{"mpcdi.xml", text}, {name, "x"}}).find("points outside of the archive"),
                  std::string::npos)
            << name;
    EXPECT_EQ(archive_error({{"mpcdi.xml", text}, {"folder/..fine", "x"}}), "");
    Entries many{{"mpcdi.xml", text}};
    for (int i = 0; i < 5000; ++i) many.push_back({"f" + std::to_string(i), ""});
    EXPECT_NE(archive_error(many).find("5001 entries"), std::string::npos);

    // Its directory states a size above the limit.
    auto bytes = zipped({{"mpcdi.xml", text}});
    const std::uint32_t size = 0xfffffff0u;
    for (std::size_t i = 0; i + 46 < bytes.size(); ++i)
        if (std::memcmp(bytes.data() + i, "PK\x01\x02", 4) == 0) std::memcpy(bytes.data() + i + 24, &size, 4);
    const auto bomb = parse_mpcdi(bytes, "a.mpcdi");
    ASSERT_FALSE(bomb);
    EXPECT_NE(std::string(bomb.error().what()).find("unpacks to more than"), std::string::npos)
        << bomb.error().what();
}

TEST(MpcdiErrors, AFlippedByteOfAStoredEntryIsFoundByItsChecksum) {
    const std::string text = xml("2d", region("region"), "");
    auto bytes = zipped({{"mpcdi.xml", text}}, ZIP_CM_STORE);
    ASSERT_TRUE(parse_mpcdi(bytes, "a.mpcdi"));
    const std::string all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    bytes[all.find("\"region\"") + 1] ^= std::byte{1};  // another name, which is valid, too
    const auto mpcdi = parse_mpcdi(bytes, "a.mpcdi");
    ASSERT_FALSE(mpcdi);
    EXPECT_NE(std::string(mpcdi.error().what()).find("'mpcdi.xml' cannot be unpacked (CRC error)"),
              std::string::npos)
        << mpcdi.error().what();
}

TEST(MpcdiErrors, DamagedArchivesAreReadOrRejected) {
    const std::string sets = files("r", std::string(Warp) + "<alphaMap><path>a.png</path></alphaMap>");
    const auto whole = zipped({{"mpcdi.xml", xml("3d", region("r", Frustum), sets)},
                               {"w.pfm", pfm(2, 2, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, NoPoint})},
                               {"a.png", text_of({1, 2, 3})}});
    ASSERT_TRUE(parse_mpcdi(whole, "a.mpcdi"));
    CounterRandom random(9);
    int refused = 0;
    for (int round = 0; round < 5000; ++round) {
        std::vector<std::byte> bytes = whole;
        if (round % 3 == 0) bytes.resize(std::size_t(random.uniform() * double(bytes.size())));
        for (int flip = 0; flip < 1 + round % 4 && !bytes.empty(); ++flip)
            bytes[std::size_t(random.uniform() * double(bytes.size()))] ^= std::byte(1u << (round % 8));
        const auto mpcdi = parse_mpcdi(bytes, "a.mpcdi");
        if (mpcdi)
            EXPECT_LT(import_mpcdi(*mpcdi, "wall").text.size(), 100000u);
        else
            ++refused;
    }
    EXPECT_GT(refused, 1000);
    for (int round = 0; round < 2000;
         ++round) {  // only the text, since bit flips of deflated data rarely reach the parser
        std::string text = xml("sl", region("r", std::string(Frustum) + Frame), sets);
        for (int flip = 0; flip < 1 + round % 3; ++flip)
            text[std::size_t(random.uniform() * double(text.size()))] = char(random.uniform() * 256.0);
        const auto mpcdi = parse_mpcdi(zipped({{"mpcdi.xml", text}}), "a.mpcdi");
        if (mpcdi) import_mpcdi(*mpcdi, "wall");
    }
}

}  // namespace
}  // namespace tessera::display_file
