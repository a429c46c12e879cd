#include "client/tools/display/pattern_command.h"

#include <filesystem>
#include <iostream>
#include <memory>

#include "client/display_file/display_file.h"
#include "mediator/display/pattern.h"
#include "mediator/display/pattern_run.h"
#include "mediator/picture/png_writer.h"

namespace tessera::tools {

namespace {

constexpr const char* PatternName = "display pattern";

struct PatternOptions {
    std::string file, folder;
    bool raw = false;
};

// Writes the device's pictures, one file each.
std::size_t write_pattern(tbb::task_arena& arena, const display::Output& output,
                          const display::Display& display, const scene::BlobStore& blobs,
                          const std::filesystem::path& folder) {
    display::OutputPipeline pipeline(output, blobs);
    std::vector<std::vector<std::uint8_t>> devices(pipeline.picture_count(),
                                                   std::vector<std::uint8_t>(pipeline.value_count()));
    const std::vector<std::span<std::uint8_t>> rooms(devices.begin(), devices.end());
    display::run_pattern(arena, pipeline, output, display, rooms);
    for (std::size_t i = 0; i < devices.size(); ++i) {
        const char* ending = devices.size() == 1 ? ".png" : i == 0 ? "-left.png" : "-right.png";
        picture::write_png((folder / (output.name + ending)).string(), output.width, output.height,
                           devices[i]);
    }
    return devices.size();
}

int run(const PatternOptions& options) {
    scene::BlobStore blobs;
    const display::Display display = display_file::read_display(options.file, blobs).display;
    std::error_code error;
    std::filesystem::create_directories(options.folder, error);
    if (error)
        throw Error(ErrorCode::Io, "cannot create the folder '" + options.folder + "': " + error.message());
    tbb::task_arena arena;
    std::size_t count = 0;
    for (const display::Output& output : display.outputs) {
        count +=
            write_pattern(arena, options.raw ? display::raw(output) : output, display, blobs, options.folder);
    }
    std::cout << "wrote " << count << " pictures into " << options.folder << "\n";
    return 0;
}

}  // namespace

Command pattern_command(cli::CommandLine& display) {
    const auto options = std::make_shared<PatternOptions>();
    cli::CommandLine& line = display.command(
        "pattern",
        "Write the test pattern of every output as its device would show it: NAME.png, or NAME-left.png and "
        "NAME-right.png where the eyes have separate pictures.");
    line.positional("FILE", "the display, as TOML: docs/displays.md", options->file);
    line.option("-o,--output", "folder for the pictures; created if missing", options->folder);
    line.required("--output");
    line.flag("--raw", "without warp, soft edges and colour correction", options->raw);
    line.examples({"tessera display pattern wall.toml -o pattern"});
    return {PatternName, [options](std::string_view) {
                try {
                    return run(*options);
                } catch (const Error& error) {
                    return report_error(PatternName, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
