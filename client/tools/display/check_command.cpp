#include "client/tools/display/check_command.h"

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "client/display_file/display_file.h"
#include "client/tools/display/display_table.h"
#include "client/tools/display/plan.h"
#include "mediator/picture/atomic_file.h"
#include "mediator/picture/png_writer.h"

namespace tessera::tools {

namespace {

constexpr const char* CheckName = "display check";

struct CheckOptions {
    std::string file;
    std::vector<std::string> plans;
};

void write_plan(const Drawing& drawing, const std::string& path) {
    if (path.ends_with(".svg")) {
        picture::write_atomically(path, as_svg(drawing));
    } else {
        const Canvas canvas = as_canvas(drawing);
        picture::write_png(path, canvas.width, canvas.height, canvas.rgb);
    }
    std::cout << "wrote " << path << "\n";
}

int run(const CheckOptions& options) {
    for (const std::string& path : options.plans) {
        if (!path.ends_with(".svg") && !path.ends_with(".png"))
            return report_error(CheckName, cli::ExitUsage,
                                "'" + path + "' is not .svg or .png: plans can only be drawn as these");
    }
    scene::BlobStore blobs;
    const display_file::DisplayFile file = display_file::read_display(options.file, blobs);
    std::cout << as_table(file.display);
    if (options.plans.empty()) return 0;
    const Drawing drawing = plan(file);
    for (const std::string& path : options.plans) write_plan(drawing, path);
    return 0;
}

}  // namespace

Command check_display_command(cli::CommandLine& display) {
    const auto options = std::make_shared<CheckOptions>();
    cli::CommandLine& line =
        display.command("check", "Check a display file, and print its outputs and bandwidth.");
    line.positional("FILE", "the display, as TOML: docs/displays.md", options->file);
    line.option("-o,--output", "draw a plan of it: .svg or .png (repeatable)", options->plans);
    line.examples({"tessera display check wall.toml", "tessera display check wall.toml -o plan.png"});
    return {CheckName, [options](std::string_view) {
                try {
                    return run(*options);
                } catch (const Error& error) {
                    return report_error(CheckName, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
