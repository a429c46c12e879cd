#include "client/tools/view_attributes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <sstream>
#include <vector>

#include "client/edit/values.h"

namespace tessera::tools {

namespace {

constexpr const char* Camera = "tessera.camera.pose";
constexpr const char* Optics = "tessera.camera.optics";  // only if not a pinhole: projection and lens
// Where it moves while the shutter is open: 16 numbers for each motion key after the pose.
constexpr const char* Motion = "tessera.camera.motion";
constexpr const char* Biased = "tessera.biased";  // only if samples are clamped: by what
constexpr const char* PathClassName = "tessera.pathClass";
constexpr std::size_t MaxKeys = 256;  // limit when reading

void put(std::string& text, double value) {
    std::array<char, 40> number{};
    std::snprintf(number.data(), number.size(), "%s%.17g", text.empty() ? "" : " ", value);
    text += number.data();
}

// Column by column.
void put(std::string& text, const glm::dmat4& matrix) {
    for (int i = 0; i < 16; ++i) put(text, matrix[i / 4][i % 4]);
}

bool get(std::istream& text, double& value) {
    return (text >> value) && std::isfinite(value);
}

bool get(std::istream& text, glm::dmat4& matrix) {
    for (int i = 0; i < 16; ++i) {
        if (!get(text, matrix[i / 4][i % 4])) return false;
    }
    return true;
}

// Nothing if the attribute is malformed.
std::optional<std::vector<glm::dmat4>> motion_of(const std::string& attribute) {
    std::istringstream text(attribute);
    std::vector<glm::dmat4> keys;
    while (!(text >> std::ws).eof()) {
        if (keys.size() == MaxKeys || !get(text, keys.emplace_back())) return std::nullopt;
    }
    return keys;
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
    put(pose, view.camera.world_from_camera);
    for (const double edge : {view.camera.left, view.camera.right, view.camera.bottom, view.camera.top})
        put(pose, edge);
    std::map<std::string, std::string> attributes{{Camera, pose}, {PathClassName, name(view.path_class)}};
    if (!view.camera.is_pinhole()) {
        std::array<char, 120> text{};
        std::snprintf(text.data(), text.size(), "%d %.17g %.17g %d", int(view.camera.projection),
                      view.camera.lens_radius, view.camera.focus_distance, int(view.camera.aperture));
        attributes[Optics] = text.data();
    }
    if (!view.camera.motion.empty()) {
        for (const glm::dmat4& key : view.camera.motion) put(attributes[Motion], key);
    }
    if (view.clamp_indirect > 0.0f) attributes[Biased] = "--clamp " + edit::number_text(view.clamp_indirect);
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
    if (!get(text, view.camera.world_from_camera) || !get(text, view.camera.left) ||
        !get(text, view.camera.right) || !get(text, view.camera.bottom) || !get(text, view.camera.top))
        return wrong(Camera);
    if (const auto optics = attributes.find(Optics); optics != attributes.end()) {
        std::istringstream numbers_of(optics->second);
        int projection = 0, aperture = 0;
        numbers_of >> projection >> view.camera.lens_radius >> view.camera.focus_distance >> aperture;
        if (!numbers_of || projection < 0 || projection > 1 || aperture < 0 || aperture > 1)
            return wrong(Optics);
        view.camera.projection = static_cast<scene::Projection>(projection);
        view.camera.aperture = static_cast<scene::Aperture>(aperture);
    }
    if (const auto motion = attributes.find(Motion); motion != attributes.end()) {
        const auto keys = motion_of(motion->second);
        if (!keys) return wrong(Motion);
        view.camera.motion = *keys;
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
