#include "client/display_file/viewer_preview.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>

#include "client/display_file/file_bytes.h"
#include "mediator/display/frustum.h"
#include "mediator/display/viewer_preview.h"
#include "mediator/picture/png_reader.h"

namespace tessera::display_file {

namespace {

using display::Output;
using display::Stereo;
using view::Eye;

// The outputs of one screen, by their indices in the display.
struct ScreenOutputs {
    std::string screen;
    std::vector<std::size_t> outputs;
};

std::vector<ScreenOutputs> outputs_by_screen(const DisplayFile& file) {
    std::vector<ScreenOutputs> result;
    for (std::size_t i = 0; i < file.display.outputs.size(); ++i) {
        const std::string& shared = file.geometry[i].screen;
        const auto found = std::ranges::find_if(
            result, [&](const ScreenOutputs& one) { return !shared.empty() && one.screen == shared; });
        if (found != result.end())
            found->outputs.push_back(i);
        else
            result.push_back({shared.empty() ? file.display.outputs[i].name : shared, {i}});
    }
    return result;
}

bool shows_two_eyes(Stereo stereo) {
    return stereo != Stereo::Mono && stereo != Stereo::AnaglyphPlain && stereo != Stereo::AnaglyphDubois;
}

// The picture file of an output for an eye; "" when that eye does not see the output.
std::string file_for(const Output& output, Eye eye) {
    if (output.stereo == Stereo::Separate)
        return output.name + (eye == Eye::Right ? "-right.png" : "-left.png");
    if ((output.stereo == Stereo::Left && eye == Eye::Right) ||
        (output.stereo == Stereo::Right && eye == Eye::Left))
        return "";
    return output.name + ".png";
}

frame::Image light_in(const std::string& path, const Output& output, double black) {
    const auto bytes = read_file(path, MostCalibrationBytes);
    if (!bytes) throw bytes.error();
    const auto picture = picture::read_png(*bytes);
    if (!picture) throw Error(ErrorCode::InvalidInput, "'" + path + "': " + picture.error().what());
    if (picture->width != output.width || picture->height != output.height || picture->components != 3)
        throw Error(ErrorCode::InvalidInput,
                    "'" + path + "' is not a colour picture of " + std::to_string(output.width) + " x " +
                        std::to_string(output.height) + " pixels, the size of output '" + output.name + "'");
    return display::light_of(output, std::span<const float>(picture->values), black);
}

// One plane for all outputs of a screen that is not flat.
display::ProjectionPlane common_plane(const DisplayFile& file, const ScreenOutputs& group) {
    display::ProjectionPlane plane = file.display.outputs[group.outputs.front()].plane;
    glm::dvec3 normal(0.0), origin(0.0);
    plane.hull.clear();
    for (const std::size_t i : group.outputs) {
        const display::ProjectionPlane& one = file.display.outputs[i].plane;
        normal += glm::cross(one.right, one.up);
        origin += one.origin / double(group.outputs.size());
        plane.hull.insert(plane.hull.end(), one.hull.begin(), one.hull.end());
    }
    if (!(glm::length(normal) > 1e-6 * double(group.outputs.size())))
        throw Error(ErrorCode::InvalidInput,
                    "screen '" + group.screen + "' surrounds the viewer: one flat picture cannot show it");
    normal = glm::normalize(normal);
    plane.origin = origin;
    plane.up = glm::normalize(plane.up - glm::dot(plane.up, normal) * normal);
    plane.right = glm::cross(plane.up, normal);
    return plane;
}

view::CameraPose camera_of(const DisplayFile& file, const ScreenOutputs& group) {
    const auto& surface = file.geometry[group.outputs.front()].surface;
    display::Head head = file.display.head;
    display::ProjectionPlane plane;
    if (const auto* wall = surface ? std::get_if<display::Wall>(&*surface) : nullptr) {
        plane = display::projection_plane(*wall);
        head.position =
            wall->corner + 0.5 * (wall->across + wall->upward) +
            (glm::length(wall->across) + glm::length(wall->upward)) * glm::cross(plane.right, plane.up);
    } else {
        plane = common_plane(file, group);
    }
    try {
        return display::frustum(plane, head, Eye::Mono, 0.0, 0.0);
    } catch (const Error& error) {
        throw Error(error.code(), "screen '" + group.screen + "': " + error.what());
    }
}

// Box filter, so that devices finer than the picture do not alias.
frame::Image shrunk(const frame::Image& image, std::uint32_t times) {
    frame::Image result(image.width / times, image.height / times, 3);
    for (std::size_t y = 0; y < std::size_t{result.height} * times; ++y)
        for (std::size_t x = 0; x < std::size_t{result.width} * times; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                result.pixel(y / times * result.width + x / times)[c] +=
                    image.pixel(y * image.width + x)[c] / float(times * times);
    return result;
}

ScreenPicture preview_of(const DisplayFile& file, const ScreenOutputs& group, Eye eye,
                         const std::string& folder, const ViewerPreviewOptions& options,
                         tbb::task_arena& arena) {
    std::vector<frame::Image> lights;
    std::vector<const display::WarpMap*> grids;
    double pixels = 0.0;
    for (const std::size_t i : group.outputs) {
        const Output& output = file.display.outputs[i];
        const std::string name = file_for(output, eye);
        if (name.empty()) continue;
        const frame::Image light =
            light_in((std::filesystem::path(folder) / name).string(), output, options.black);
        lights.push_back(display::part_of_eye(output, light, eye));
        grids.push_back(&file.geometry[i].points);
        pixels += double(light.pixel_count());
    }
    std::vector<display::ProjectedOutput> outputs;
    for (std::size_t i = 0; i < lights.size(); ++i) outputs.push_back({grids[i], &lights[i]});
    const view::CameraPose camera = camera_of(file, group);
    const double shape = (camera.top - camera.bottom) / (camera.right - camera.left);
    const auto height =
        std::uint32_t(std::clamp(std::round(options.width * shape), 1.0, double(display::MaxEdge)));
    constexpr double FinestSamples = 4.0;  // per side: 16 per pixel
    const auto times = std::uint32_t(
        std::clamp(std::ceil(std::sqrt(pixels / (double(options.width) * height))), 1.0, FinestSamples));
    return {group.screen, eye,
            shrunk(display::viewer_picture(camera, options.width * times, height * times, outputs, arena),
                   times)};
}

}  // namespace

std::vector<ScreenPicture> simulate_viewer(const DisplayFile& file, const std::string& folder,
                                           const ViewerPreviewOptions& options, tbb::task_arena& arena) {
    std::vector<ScreenPicture> pictures;
    for (const ScreenOutputs& group : outputs_by_screen(file)) {
        const bool is_stereo = std::ranges::any_of(
            group.outputs, [&](std::size_t i) { return shows_two_eyes(file.display.outputs[i].stereo); });
        for (const Eye eye : is_stereo ? std::vector{Eye::Left, Eye::Right} : std::vector{Eye::Mono})
            pictures.push_back(preview_of(file, group, eye, folder, options, arena));
    }
    return pictures;
}

}  // namespace tessera::display_file
