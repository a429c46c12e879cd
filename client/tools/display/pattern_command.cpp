#include "client/tools/display/pattern_command.h"

#include <filesystem>
#include <glm/gtc/packing.hpp>
#include <iostream>
#include <memory>

#include "client/display_file/display_file.h"
#include "mediator/display/frustum.h"
#include "mediator/display/output_pipeline.h"
#include "mediator/display/pattern.h"
#include "mediator/picture/png_writer.h"

namespace tessera::tools {

namespace {

constexpr const char* Name = "display pattern";

struct PatternOptions {
    std::string file, folder;
    bool raw = false;
};

std::vector<std::uint16_t> halves(const frame::Image& image) {
    std::vector<std::uint16_t> values;
    values.reserve(image.values.size());
    for (const float value : image.values) values.push_back(glm::packHalf1x16(value));
    return values;
}

// Where the eye is that sees the screen as the picture shows it, zero parallax or not.
view::CameraPose seen_by(const display::Output& output, const display::Display& display, view::Eye eye) {
    const glm::dvec3 normal = glm::cross(output.plane.right, output.plane.up);
    const double distance = glm::dot(display.head.position - output.plane.origin, normal);
    const double scale = display.zero_parallax > 0.0 ? distance / display.zero_parallax : 1.0;
    return display::frustum(output.plane, display.head, eye, display.eye_separation * scale, 0.0);
}

// What the device would show, a file for each of its pictures.
std::size_t write_pattern(tbb::task_arena& arena, const display::Output& output,
                          const display::Display& display, const scene::BlobStore& blobs,
                          const std::filesystem::path& folder) {
    display::OutputPipeline pipeline(output, blobs);
    std::vector<std::vector<std::uint16_t>> light;
    std::vector<display::EyePicture> pictures;
    for (const view::Eye eye : display::eyes(output.stereo)) {
        if (!output.points.empty()) pipeline.set_frustum(eye, seen_by(output, display, eye));
        light.push_back(halves(display::pattern(output, eye)));
    }
    for (const std::vector<std::uint16_t>& values : light) {
        pictures.push_back({.width = output.view_width,
                            .height = output.view_height,
                            .values = std::as_bytes(std::span(values))});
    }
    std::vector<std::vector<std::uint8_t>> devices(pipeline.picture_count(),
                                                   std::vector<std::uint8_t>(pipeline.value_count()));
    const std::vector<std::span<std::uint8_t>> rooms(devices.begin(), devices.end());
    pipeline.run(arena, pictures, rooms);
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
        throw Error(ErrorCode::Io, "cannot make the folder '" + options.folder + "': " + error.message());
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
        "NAME-right.png where the eyes have pictures of their own.");
    line.positional("FILE", "the display, as TOML: docs/displays.md", options->file);
    line.option("-o,--output", "folder for the pictures; made when it is not there", options->folder);
    line.required("--output");
    line.flag("--raw", "without warp, soft edges and colour: the device's own pixels", options->raw);
    line.examples({"tessera display pattern wall.toml -o pattern"});
    return {Name, [options](std::string_view) {
                try {
                    return run(*options);
                } catch (const Error& error) {
                    return complain(Name, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
