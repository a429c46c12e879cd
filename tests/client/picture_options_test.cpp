// Options that several commands share: denoisers, exposure and view transform, as they are typed.
#include <gtest/gtest.h>

#include <sstream>

#include "client/tools/display_transform_options.h"
#include "client/tools/filter_options.h"

namespace tessera::tools {
namespace {

struct Typed {
    std::optional<int> exit;
    std::string scene, error;
    FilterOption filter;
    DisplayTransformOptions display;
};

Typed typed(std::vector<const char*> words) {
    Typed result;
    cli::CommandLine line("tessera", "a test");
    cli::CommandLine& command = line.command("render", "a command");
    command.positional("SCENE", "a file", result.scene);
    result.filter.add_to(command);
    result.display.add_to(command);
    words.insert(words.begin(), {"tessera", "render"});
    std::ostringstream out, err;
    result.exit = line.parse(static_cast<int>(words.size()), words.data(), out, err);
    result.error = err.str();
    return result;
}

TEST(FilterOption, DenoiseWithoutValueUsesTheDefaultAndNotTheNextArgument) {
    const Typed result = typed({"--denoise", "room.glb"});
    EXPECT_FALSE(result.exit) << result.error;
    EXPECT_EQ(result.scene, "room.glb");
    const auto filter = parse_options(result.filter);
    ASSERT_TRUE(filter);
    EXPECT_TRUE(filter->starts_with("fdf")) << *filter;
}

TEST(FilterOption, DenoiseAndFilterAreSynonyms) {
    const auto denoised = parse_options(typed({"room.glb", "--denoise=gauss:sigma=3"}).filter);
    const auto filtered = parse_options(typed({"room.glb", "--filter", "gauss:sigma=3"}).filter);
    ASSERT_TRUE(denoised && filtered);
    EXPECT_EQ(*denoised, *filtered);
    EXPECT_EQ(*parse_options(typed({"room.glb"}).filter), "");
}

TEST(FilterOption, ErrorsNameTheProblem) {
    const auto problem = [](std::vector<const char*> words) {
        const auto filter = parse_options(typed(std::move(words)).filter);
        return filter ? std::string() : std::string(filter.error().what());
    };
    EXPECT_NE(problem({"room.glb", "--denoise", "--filter", "fdf"}).find("give one of them"),
              std::string::npos);
    EXPECT_NE(problem({"room.glb", "--denoise=fdff"}).find("--denoise: "), std::string::npos);
    EXPECT_NE(problem({"room.glb", "--filter=fdff"}).find("--filter: "), std::string::npos);
}

TEST(DisplayTransformOptions, ExposureIsANumberOfStopsOrAuto) {
    const auto exposure = [](const char* text) {
        return parse_options(typed({"room.glb", "--exposure", text}).display);
    };
    EXPECT_FALSE(exposure("auto")->transform.exposure);
    EXPECT_EQ(*exposure("1.5")->transform.exposure, 1.5);
    EXPECT_EQ(*exposure("-2")->transform.exposure, -2.0);
    EXPECT_EQ(*exposure("+60")->transform.exposure, 60.0);
    for (const char* wrong : {"", "bright", "1.5x", "nan", "inf", "61", "-61", "1e999", "++1"}) {
        const auto transform = exposure(wrong);
        ASSERT_FALSE(transform) << wrong;
        EXPECT_NE(std::string(transform.error().what()).find("neither auto nor a number"), std::string::npos);
    }
}

TEST(DisplayTransformOptions, OptionsWithoutEffectAreReported) {
    const DisplayTransformOptions none, bright{.exposure = "1"}, linear{.view_transform = "linear"};
    EXPECT_FALSE(unused_display_options(none, {"a.exr"}));
    EXPECT_FALSE(unused_display_options(bright, {"a.exr", "a.png"}));
    EXPECT_TRUE(unused_display_options(bright, {"a.exr"})->starts_with("--exposure has no effect"));
    EXPECT_TRUE(unused_display_options(linear, {"a.EXR"})->starts_with("--view-transform"));
}

TEST(DisplayTransformOptions, TransformsAreNamed) {
    EXPECT_EQ(parse_options(typed({"room.glb"}).display)->transform.view_transform,
              view::ViewTransform::Neutral);
    EXPECT_EQ(parse_options(typed({"room.glb", "--view-transform", "agx"}).display)->transform.view_transform,
              view::ViewTransform::Agx);
    const Typed wrong = typed({"room.glb", "--view-transform", "agz"});
    EXPECT_EQ(wrong.exit.value_or(0), cli::ExitUsage);
    EXPECT_NE(wrong.error.find("did you mean 'agx'"), std::string::npos) << wrong.error;
}

}  // namespace
}  // namespace tessera::tools
