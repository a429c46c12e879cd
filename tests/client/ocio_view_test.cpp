// `--ocio CONFIG[:DISPLAY[:VIEW]]`: views of OpenColorIO configurations, of which those here have known values.
#include "client/tools/ocio_view.h"

#include <gmock/gmock.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "client/tools/render_options.h"
#include "mediator/picture/picture_encoder.h"

namespace tessera::tools {
namespace {

using testing::HasSubstr;

std::string problem_of(const std::string& specification) {
    const auto view = load_ocio_view(specification);
    return view ? "none" : view.error().what();
}

#ifdef TESSERA_OCIO

// Display "monitor" halves light or leaves it; "projector" squares it.
constexpr const char* Named = R"(ocio_profile_version: 2
roles: {default: lin_rec709, scene_linear: lin_rec709}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  monitor:
    - !<View> {name: half, colorspace: half}
    - !<View> {name: plain, colorspace: lin_rec709}
  projector:
    - !<View> {name: square, colorspace: square}
active_displays: [monitor, projector]
active_views: []
colorspaces:
  - !<ColorSpace> {name: lin_rec709}
  - !<ColorSpace>
    name: half
    from_scene_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}
  - !<ColorSpace>
    name: square
    from_scene_reference: !<ExponentTransform> {value: [2, 2, 2, 1]}
)";

// The reference is ACES2065-1, and nothing says what Rec. 709 is.
constexpr const char* Aces = R"(ocio_profile_version: 2
roles: {default: ACES2065-1, aces_interchange: ACES2065-1}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  monitor:
    - !<View> {name: raw, colorspace: ACES2065-1}
active_displays: []
active_views: []
colorspaces:
  - !<ColorSpace> {name: ACES2065-1}
)";

class OcioView : public testing::Test {
  protected:
    OcioView() {
        std::string name = std::filesystem::temp_directory_path() / "tessera-ocio-XXXXXX";
        folder_ = ::mkdtemp(name.data());
    }
    ~OcioView() override { std::filesystem::remove_all(folder_); }

    std::string config(const char* name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
        return folder_ / name;
    }

    std::filesystem::path folder_;
};

std::array<float, 3> shown(const std::string& specification, std::array<float, 3> light) {
    const auto view = load_ocio_view(specification);
    EXPECT_TRUE(view) << (view ? "" : view.error().what());
    if (view) view->apply(light);
    return light;
}

TEST_F(OcioView, DisplayAndViewAreChosen) {
    const std::string file = config("named.ocio", Named);
    EXPECT_THAT(shown(file, {0.5f, 1.0f, 0.25f}), testing::ElementsAre(0.25f, 0.5f, 0.125f));
    EXPECT_THAT(shown(file + ":monitor", {0.5f, 1.0f, 0.25f}), testing::ElementsAre(0.25f, 0.5f, 0.125f));
    EXPECT_THAT(shown(file + ":monitor:plain", {0.5f, 1.0f, 0.25f}), testing::ElementsAre(0.5f, 1.0f, 0.25f));
    const auto square = shown(file + ":projector:square", {0.5f, 1.0f, 0.25f});
    EXPECT_NEAR(square[0], 0.25f, 1e-6f);
    EXPECT_NEAR(square[2], 0.0625f, 1e-6f);
}

TEST_F(OcioView, LightIsConvertedThroughTheInterchangeRole) {
    const std::string file = config("aces.ocio", Aces);
    const auto red = shown(file, {1.0f, 0.0f, 0.0f});
    EXPECT_NEAR(red[0], 0.4396f, 1e-4f);
    EXPECT_NEAR(red[1], 0.0896f, 1e-4f);
    EXPECT_NEAR(red[2], 0.0174f, 1e-4f);
    for (const float white : shown(file, {1.0f, 1.0f, 1.0f})) EXPECT_NEAR(white, 1.0f, 1e-5f);
}

TEST_F(OcioView, KnownLightGivesKnownBytes) {
    const auto view = load_ocio_view(config("named.ocio", Named));
    ASSERT_TRUE(view);
    frame::Image image(2, 1, 3);
    image.values = {0.5f, 1.0f, 0.25f, 4.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()};
    // The exposure of one stop doubles light, the view halves it: 0.5, 1, 0.25 of 255; the rest is clipped.
    EXPECT_THAT(picture::display_bytes(image, {.exposure = 1.0}, &*view),
                testing::ElementsAre(128, 255, 64, 255, 0, 0));
    const auto png = picture::encode_picture(image, picture::FileFormat::Png, {.exposure = 1.0}, &*view);
    const std::string bytes(reinterpret_cast<const char*>(png.data()), png.size());
    EXPECT_THAT(bytes, HasSubstr("OpenColorIO monitor, half, exposure +1.00 EV"));
    EXPECT_THAT(bytes, testing::Not(HasSubstr("sRGB"))) << "the file must not say that it is sRGB";
}

TEST_F(OcioView, DenoisedPicturesAreEncodedByTheClient) {
    RenderOptions options;
    options.view.scene = "room.glb";
    options.outputs = {"room.png"};
    options.filter.denoise = "fdf";
    const auto plain = parse_options(options);
    ASSERT_TRUE(plain) << plain.error().what();
    EXPECT_EQ(plain->job.picture, session::PictureEncoding::Png);
    options.display.ocio = config("named.ocio", Named);
    const auto custom = parse_options(options);
    ASSERT_TRUE(custom) << custom.error().what();
    EXPECT_EQ(custom->job.picture, session::PictureEncoding::Planes);
    ASSERT_TRUE(custom->custom_view);
    EXPECT_EQ(custom->custom_view->name, "OpenColorIO monitor, half");
    options.master = "tcp://127.0.0.1:7420";
    options.name = "night";
    options.detach = true;
    const auto job = parse_options(options);
    ASSERT_FALSE(job);
    EXPECT_THAT(job.error().what(), HasSubstr("--ocio: the master encodes the picture of a job"));
}

TEST_F(OcioView, ErrorsNameWhatThereIs) {
    const std::string file = config("named.ocio", Named);
    EXPECT_THAT(problem_of(file + ":tv"), HasSubstr("there is no display 'tv'; it has monitor, projector"));
    EXPECT_THAT(problem_of(file + ":monitor:film"), HasSubstr("has no view 'film'; it has half, plain"));
    EXPECT_THAT(problem_of(folder_ / "absent.ocio"), HasSubstr("absent.ocio"));
    EXPECT_THAT(problem_of(config("bad.ocio", "displays: [")), HasSubstr("bad.ocio"));
    EXPECT_THAT(problem_of(""), HasSubstr("name a configuration"));
    std::string unknown = Named;
    for (std::size_t at; (at = unknown.find("lin_rec709")) != std::string::npos;)
        unknown.replace(at, 10, "light");
    EXPECT_THAT(problem_of(config("unknown.ocio", unknown)), HasSubstr("aces_interchange"));
}

#else

TEST(OcioView, ABuildWithoutOpenColorIoSaysSo) {
    EXPECT_THAT(problem_of("config.ocio"),
                HasSubstr("this build has no OpenColorIO: install libopencolorio-dev"));
}

#endif

}  // namespace
}  // namespace tessera::tools
