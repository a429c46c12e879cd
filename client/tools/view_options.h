#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/import/configure.h"
#include "client/import/import.h"
#include "client/tools/values.h"
#include "mediator/program/command_line.h"
#include "mediator/view/view.h"

namespace tessera::tools {

// The options shared by render, coverage and probe, as typed.
struct ViewOptions {
    std::string scene;
    std::string size = "1280x720";
    std::optional<std::string> camera, background, environment, crop, layers, animation;
    std::optional<double> at, lens_radius, focus, orthographic, shutter;
    std::string aperture;
    std::vector<std::string> hidden, materials, lights_as_sky;
    double environment_strength = 1.0, environment_rotation = 0.0;
    bool solid_glass = false, soft_lights_as_sky = false;
    std::string light_units = "physical";
    std::uint32_t bounces = 8, specular_bounces = 32;
    std::optional<double> clamp;
    std::string sky_sampling = "visible";
    std::string pixel_filter = "box";
    std::uint64_t seed = 0;
    std::string renderer = "path", path_class = "indirect", feature_rule = "demodulated";
    bool transparent = false;

    void add_scene_to(cli::CommandLine& command);  // options that do not concern lighting
    void add_to(cli::CommandLine& command);        // all options
};

// The validated options.
struct ViewPlan {
    std::string scene;
    import::ImportOptions import;
    import::Configuration configuration;
    std::optional<std::string> camera;
    std::optional<double> lens_radius, focus_distance, orthographic_height;  // override the camera's
    std::optional<scene::Aperture> aperture;
    Size size;
    view::View view;  // without camera and channels
};
Expected<ViewPlan> parse_options(const ViewOptions& options);

// Imports the scene and applies the chosen configuration.
Expected<import::ImportedScene> import_scene(const ViewPlan& plan);

// By name, else by number from 0; the first by default. The error suggests the nearest name.
Expected<import::CameraInfo> choose_camera(const std::vector<import::CameraInfo>& cameras,
                                           const std::optional<std::string>& choice);

// plan.view with the camera and the overrides of the plan.
view::View view_from(const ViewPlan& plan, const import::CameraInfo& camera);

}  // namespace tessera::tools
