#include "client/tools/display/audience_command.h"

#include <filesystem>
#include <iostream>
#include <memory>

#include "client/display_file/audience.h"
#include "mediator/picture/png_writer.h"
#include "mediator/picture/srgb_bytes.h"

namespace tessera::tools {

namespace {

constexpr const char* AudienceName = "display audience";

struct AudienceCommandOptions {
    std::string file, pictures, output;
    display_file::AudienceOptions audience;
};

// wall.png; wall-SCREEN.png of several screens; -left and -right where the eyes see different pictures.
std::string path_of(const std::string& output, const display_file::ScreenPicture& picture, bool has_name) {
    std::filesystem::path path(output);
    std::string stem = path.stem().string();
    if (has_name) stem += "-" + picture.screen;
    if (picture.eye != view::Eye::Mono) stem += picture.eye == view::Eye::Left ? "-left" : "-right";
    return path.replace_filename(stem + ".png").string();
}

int run(const AudienceCommandOptions& options) {
    if (options.audience.width < 1 || options.audience.width > display::MaxEdge)
        throw Error(ErrorCode::InvalidInput, "--width must be 1 to " + std::to_string(display::MaxEdge));
    if (!(options.audience.black >= 0.0 && options.audience.black < 1.0))
        throw Error(ErrorCode::InvalidInput, "--black must be at least 0 and less than 1");
    scene::BlobStore blobs;
    const display_file::DisplayFile file = display_file::read_display(options.file, blobs);
    tbb::task_arena arena;
    const auto pictures = display_file::what_people_see(file, options.pictures, options.audience, arena);
    const bool has_names = pictures.front().screen != pictures.back().screen;
    const picture::SrgbBytes srgb;
    for (const display_file::ScreenPicture& picture : pictures) {
        std::vector<std::uint8_t> bytes;
        bytes.reserve(picture.light.values.size());
        for (const float value : picture.light.values) bytes.push_back(srgb(value));
        const std::string path = path_of(options.output, picture, has_names);
        picture::write_png(path, picture.light.width, picture.light.height, bytes);
        std::cout << "wrote " << path << "\n";
    }
    return 0;
}

}  // namespace

Command audience_command(cli::CommandLine& display) {
    const auto options = std::make_shared<AudienceCommandOptions>();
    cli::CommandLine& line = display.command("audience",
                                             "Show what people in front of the screens see of pictures that "
                                             "output processes wrote: each is thrown "
                                             "back onto its screen, overlaps add up.");
    line.positional("FILE", "the display, as TOML: docs/displays.md", options->file);
    line.option("--pictures", "folder with NAME.png, or NAME-left.png and NAME-right.png, of each output",
                options->pictures);
    line.required("--pictures");
    line.option("-o,--output", "picture to write; several screens and eyes add their names to it",
                options->output);
    line.required("--output");
    line.option("--width", "pixels of the picture; the height follows from the screen",
                options->audience.width);
    line.option("--black", "light of a device that is sent black, as a part of its white",
                options->audience.black);
    line.examples({"tessera display audience wall.toml --pictures out -o wall.png"});
    return {AudienceName, [options](std::string_view) {
                try {
                    return run(*options);
                } catch (const Error& error) {
                    return complain(AudienceName, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
