// Documented names of version 0.1 still work, with a hint: options, sub-commands, parameters of denoisers, channels in EXR files.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "client/tools/filter_options.h"
#include "mediator/frame/channels.h"
#include "mediator/picture/exr_writer.h"
#include "mediator/picture/film_exr.h"
#include "mediator/program/command_line.h"

namespace tessera::tools {
namespace {

struct ParsedLine {
    std::optional<int> exit;
    std::string chosen, owner, width, error;
};

ParsedLine parsed_line(std::vector<const char*> words) {
    ParsedLine result;
    cli::CommandLine line("tessera", "a test");
    line.command("jobs", "a command").option("--owner", "a user", result.owner);
    line.command("display", "a group of commands")
        .command("preview", "a command")
        .option("--width", "a number", result.width);
    words.insert(words.begin(), "tessera");
    std::ostringstream out, err;
    result.exit = line.parse(static_cast<int>(words.size()), words.data(), out, err);
    result.chosen = result.exit ? "" : line.chosen();
    result.error = err.str();
    return result;
}

TEST(OldNames, SubCommandsWork) {
    const ParsedLine old = parsed_line({"display", "audience"});
    EXPECT_FALSE(old.exit);
    EXPECT_EQ(old.chosen, "display preview");
    EXPECT_EQ(old.error,
              "tessera: 'audience' is now 'preview'; the old name goes away with the next version\n");
    EXPECT_EQ(parsed_line({"display", "preview"}).error, "");
    EXPECT_TRUE(parsed_line({"audience"}).exit) << "it was never a command of its own";
}

TEST(OldNames, OptionsWork) {
    for (const std::vector<const char*>& words :
         {std::vector{"jobs", "--of", "anna"}, std::vector{"jobs", "--of=anna"}}) {
        const ParsedLine old = parsed_line(words);
        EXPECT_FALSE(old.exit) << old.error;
        EXPECT_EQ(old.owner, "anna");
        EXPECT_NE(old.error.find("'--of' is now '--owner'"), std::string::npos) << old.error;
    }
    // A value that looks like an old name stays.
    EXPECT_EQ(parsed_line({"jobs", "--owner", "audience"}).owner, "audience");
}

TEST(OldNames, KeysAndTablesOfConfigurationFilesWork) {
    std::string folder = std::filesystem::temp_directory_path() / "tessera-old-XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    const std::string file = folder + "/tessera.toml";
    std::ofstream(file) << "[jobs]\nof = \"anna\"\n[display.audience]\nwidth = \"640\"\n";
    EXPECT_EQ(parsed_line({"--config", file.c_str(), "jobs"}).owner, "anna");
    for (const char* command : {"preview", "audience"})
        EXPECT_EQ(parsed_line({"--config", file.c_str(), "display", command}).width, "640") << command;
    std::filesystem::remove_all(folder);
}

TEST(OldNames, ParametersOfDenoisersWork) {
    const auto meaning = [](const char* text) {
        FilterOption option;
        option.denoise = text;
        const auto filter = parse_options(option);
        return filter ? *filter : std::string(filter.error().what());
    };
    EXPECT_EQ(meaning("fdf:fade=off"), "fdf:blend=off");
    EXPECT_EQ(meaning("psvgf:light_fade=0.5,young=8"), meaning("psvgf:light_history=0.5,min_history=8"));
    EXPECT_NE(meaning("gauss:fade=off").find("has no parameter 'fade'"), std::string::npos);
}

TEST(OldNames, ChannelsOfOlderFilmsAreRead) {
    EXPECT_EQ(frame::channel_by_name("range"), frame::Channel::Headlight);
    EXPECT_EQ(frame::channel_by_name("even_half"), frame::Channel::HalfBufferA);
    std::string folder = std::filesystem::temp_directory_path() / "tessera-old-XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    const auto planes = [](const std::string& channel, std::uint32_t count, float value) {
        picture::Layer layer{"statistics." + channel, {}, frame::Image(4, 2, count)};
        for (std::uint32_t plane = 0; plane < count; ++plane)
            layer.components.push_back("p" + std::to_string(plane));
        std::fill(layer.image.values.begin(), layer.image.values.end(), value);
        return layer;
    };
    const std::uint32_t radiance = frame::info(frame::Channel::Radiance).plane_count();
    picture::write_exr(folder + "/film.exr", 4, 2, {0, 0, 4, 2},
                       {planes("radiance", radiance, 0.5f),
                        planes("range", 3, 0.25f),
                        {"samples", {"count"}, frame::Image(4, 2, 1), true}},
                       {});
    const picture::FilmFile file = picture::read_film_exr(folder + "/film.exr");
    EXPECT_TRUE(file.film.channels.contains(frame::Channel::Headlight));
    const std::uint32_t first = file.film.channels.first_plane(frame::Channel::Headlight);
    EXPECT_EQ(file.film.plane(first)[0], 0.25f);
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace tessera::tools
