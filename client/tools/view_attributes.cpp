#include "client/tools/view_attributes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace tessera::tools {

namespace {

constexpr const char* Camera = "tessera.camera.pose";
constexpr const char* Optics = "tessera.camera.optics";  // where it is no pinhole: projection and lens
constexpr const char* PathClassName = "tessera.pathClass";

std::array<double, 20> numbers(const view::CameraPose& pose) {
    std::array<double, 20> values{};
    for (int i = 0; i < 16; ++i) values[static_cast<std::size_t>(i)] = pose.world_from_camera[i / 4][i % 4];
    values[16] = pose.left;
    values[17] = pose.right;
    values[18] = pose.bottom;
    values[19] = pose.top;
    return values;
}

}  // namespace

const std::vector<std::string>& path_class_names() {
    static const std::vector<std::string> Names{"indirect", "caustics", "diffuse", "all", "none"};
    return Names;
}

const char* name(view::PathClass path_class) {
    return path_class_names()[static_cast<std::size_t>(path_class)].c_str();
}

std::map<std::string, std::string> view_attributes(const view::View& view) {
    std::string pose;
    for (const double value : numbers(view.camera)) {
        std::array<char, 40> text{};
        std::snprintf(text.data(), text.size(), "%s%.17g", pose.empty() ? "" : " ", value);
        pose += text.data();
    }
    std::map<std::string, std::string> attributes{{Camera, pose}, {PathClassName, name(view.path_class)}};
    if (!view.camera.is_pinhole()) {
        std::array<char, 120> text{};
        std::snprintf(text.data(), text.size(), "%d %.17g %.17g %d", int(view.camera.projection),
                      view.camera.lens_radius, view.camera.focus_distance, int(view.camera.aperture));
        attributes[Optics] = text.data();
    }
    return attributes;
}

Expected<view::View> view_from_attributes(const std::map<std::string, std::string>& attributes) {
    const auto wrong = [](const std::string& attribute) {
        return failure(ErrorCode::InvalidInput,
                       "its attribute '" + attribute +
                           "' is missing or damaged: render it again with --save-statistics");
    };
    view::View view;
    const auto pose = attributes.find(Camera);
    if (pose == attributes.end()) return wrong(Camera);
    std::istringstream text(pose->second);
    std::array<double, 20> values{};
    for (double& value : values) {
        if (!(text >> value) || !std::isfinite(value)) return wrong(Camera);
    }
    for (int i = 0; i < 16; ++i)
        view.camera.world_from_camera[i / 4][i % 4] = values[static_cast<std::size_t>(i)];
    view.camera.left = values[16];
    view.camera.right = values[17];
    view.camera.bottom = values[18];
    view.camera.top = values[19];
    if (const auto optics = attributes.find(Optics); optics != attributes.end()) {
        std::istringstream numbers_of(optics->second);
        int projection = 0, aperture = 0;
        numbers_of >> projection >> view.camera.lens_radius >> view.camera.focus_distance >> aperture;
        if (!numbers_of || projection < 0 || projection > 1 || aperture < 0 || aperture > 1)
            return wrong(Optics);
        view.camera.projection = static_cast<scene::Projection>(projection);
        view.camera.aperture = static_cast<scene::Aperture>(aperture);
    }
    const auto& names = path_class_names();
    const auto path_class = attributes.find(PathClassName);
    const auto found = path_class == attributes.end()
                           ? names.end()
                           : std::find(names.begin(), names.end(), path_class->second);
    if (found == names.end()) return wrong(PathClassName);
    view.path_class = static_cast<view::PathClass>(found - names.begin());
    return view;
}

}  // namespace tessera::tools
