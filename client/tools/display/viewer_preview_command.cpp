#include "client/tools/display/viewer_preview_command.h"

#include <filesystem>
#include <iostream>
#include <memory>

#include "client/display_file/viewer_preview.h"
#include "mediator/picture/png_writer.h"
#include "mediator/picture/srgb_bytes.h"

namespace tessera::tools {

namespace {

constexpr const char* ViewerPreviewName = "display preview";

struct ViewerPreviewCommandOptions {
    std::string file, pictures, output;
    display_file::ViewerPreviewOptions preview;
};

// wall.png; wall-SCREEN.png of several screens; -left and -right where the eyes see different pictures.
std::string path_of(const std::string& output, const display_file::ScreenPicture& picture, bool has_name) {
    std::filesystem::path path(output);
    std::string stem = path.stem().string();
    if (has_name) stem += "-" + picture.screen;
    if (picture.eye != view::Eye::Mono) stem += picture.eye == view::Eye::Left ? "-left" : "-right";
    return path.replace_filename(stem + ".png").string();
}

int run(const ViewerPreviewCommandOptions& options) {
    if (options.preview.width < 1 || options.preview.width > display::MaxEdge)
        throw Error(ErrorCode::InvalidInput, "--width must be 1 to " + std::to_string(display::MaxEdge));
    if (!(options.preview.black >= 0.0 && options.preview.black < 1.0))
        throw Error(ErrorCode::InvalidInput, "--black must be at least 0 and less than 1");
    scene::BlobStore blobs;
    const display_file::DisplayFile file = display_file::read_display(options.file, blobs);
    tbb::task_arena arena;
    const auto pictures = display_file::simulate_viewer(file, options.pictures, options.preview, arena);
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

Command viewer_preview_command(cli::CommandLine& display) {
    const auto options = std::make_shared<ViewerPreviewCommandOptions>();
    cli::CommandLine& line =
        display.command("preview",
                        "Simulate what a viewer in front of the screens sees: pictures written "
                        "by output processes are projected back onto their screens, and "
                        "overlaps add up.");
    line.positional("FILE", "the display, as TOML: docs/displays.md", options->file);
    line.option("--pictures", "folder with NAME.png, or NAME-left.png and NAME-right.png, of each output",
                options->pictures);
    line.required("--pictures");
    line.option("-o,--output", "picture to write; for several screens or eyes their names are appended",
                options->output);
    line.required("--output");
    line.option("--width", "pixels of the picture; the height follows from the screen",
                options->preview.width);
    line.option("--black", "black level of the devices, as a fraction of white", options->preview.black);
    line.examples({"tessera display preview wall.toml --pictures out -o wall.png"});
    return {ViewerPreviewName, [options](std::string_view) {
                try {
                    return run(*options);
                } catch (const Error& error) {
                    return report_error(ViewerPreviewName, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
