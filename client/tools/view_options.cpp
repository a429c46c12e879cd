#include "client/tools/view_options.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/edit/values.h"
#include "client/tools/view_attributes.h"
#include "mediator/base/nearest.h"

namespace tessera::tools {

namespace {

view::PixelFilter pixel_filter(const std::string& name) {
    if (name == "gaussian") return {view::PixelFilterKind::Gaussian, 1.5f};
    if (name == "blackman-harris") return {view::PixelFilterKind::BlackmanHarris, 1.5f};
    return {view::PixelFilterKind::Box, 0.5f};
}

tl::unexpected<Error> wrong(const std::string& option, const Error& error) {
    return failure(ErrorCode::InvalidInput, option + ": " + error.what());
}

Expected<void> set_optics(const ViewOptions& options, ViewPlan& plan) {
    const auto within = [](const std::optional<double>& value, double low, double high) {
        return !value || (*value >= low && *value <= high);
    };
    if (!within(options.orthographic, 1e-9, 1e12))
        return failure(ErrorCode::InvalidInput, "--orthographic: must be a height of 1e-9 to 1e12 metres");
    if (!within(options.lens_radius, 0.0, 1e6))
        return failure(ErrorCode::InvalidInput, "--lens-radius: must be 0 to 1e6 metres");
    if (!within(options.focus, 1e-6, 1e12))
        return failure(ErrorCode::InvalidInput, "--focus: must be a distance of 1e-6 to 1e12 metres");
    plan.orthographic_height = options.orthographic;
    plan.lens_radius = options.lens_radius;
    plan.focus_distance = options.focus;
    if (options.aperture == "uniform") plan.aperture = scene::Aperture::Uniform;
    if (options.aperture == "gaussian") plan.aperture = scene::Aperture::Gaussian;
    return {};
}

constexpr std::uint64_t MaxPixels = std::uint64_t{1} << 28;  // limit of a master per view

// What the importer is to make of the file.
Expected<void> set_import(const ViewOptions& options, import::ImportOptions& import) {
    if (options.at && !(std::abs(*options.at) <= 1e9))
        return failure(ErrorCode::InvalidInput, "--at: must be a number of seconds up to 1e9");
    import.at = options.at;
    if (options.shutter && !(*options.shutter >= 0.0 && *options.shutter <= 1e9))
        return failure(ErrorCode::InvalidInput, "--shutter: must be 0 to 1e9 seconds");
    import.shutter = options.shutter.value_or(0.0);
    import.animation = options.animation.value_or("");
    if (options.environment) import.environment = *options.environment;
    if (!std::isfinite(options.environment_strength) || options.environment_strength < 0.0) {
        return failure(ErrorCode::InvalidInput, "--env-strength: must be a finite number from 0");
    }
    import.environment_strength = static_cast<float>(options.environment_strength);
    if (!std::isfinite(options.environment_rotation))
        return failure(ErrorCode::InvalidInput, "--env-rotation: must be a finite number of degrees");
    import.environment_rotation =
        static_cast<float>(std::remainder(options.environment_rotation, 360.0) * (std::numbers::pi / 180.0));
    if (options.solid_glass) import.glass = import::Glass::Solid;
    import.lights_as_sky = options.lights_as_sky;
    import.soft_lights_as_sky = options.soft_lights_as_sky;
    if (options.light_units == "blender") import.light_units = import::LightUnits::Blender;
    return {};
}

}  // namespace

void ViewOptions::add_scene_to(cli::CommandLine& command) {
    command.positional(
        "SCENE",
        "scene file: .gltf, .glb, .obj, .ply, .stl, .tessera, .x3d (lights use inverse-square falloff)",
        scene);
    command.option("--size", "picture size in pixels", size);
    command.option("--camera", "camera of the scene, by name or by number from 0", camera);
    command.option("--orthographic", "orthographic camera with this picture height in metres", orthographic);
    command.option("--lens-radius",
                   "lens radius in metres, for depth of field; 0 = pinhole (default: the camera's)",
                   lens_radius);
    command.option("--focus", "focus distance along the camera axis in metres (default: the camera's)",
                   focus);
    command.choice("--aperture", "transmission profile of the lens aperture (default: the camera's)",
                   aperture, {"uniform", "gaussian"});
    command.option("--at", "time in the scene's animations, in seconds (default: the rest pose)", at);
    command.option("--shutter", "shutter time in seconds, from the time of --at, for motion blur (0)",
                   shutter);
    command.option("--animation", "play only this animation, by name or by number from 0 (default: all)",
                   animation);
    command.option("--hide", "hide this part, by its name in the file; may be given several times", hidden);
    command.option("--material",
                   "PART=MATERIAL: assign a material to a part, both by name; may be given several times",
                   materials);
    command.option("--crop", "render only the crop window X,Y,W,H of the picture, in pixels", crop);
    command.option("--layers", "render only objects in these object layers, 0 to 31, as 0,2 (all)", layers);
    command.option("--seed", "seed of the random numbers", seed);
}

void ViewOptions::add_to(cli::CommandLine& command) {
    add_scene_to(command);
    command.option("--background",
                   "uniform environment light: linear R,G,B (scenes without lights get a default sky)",
                   background);
    command.option("--env", "environment map, latitude-longitude .exr or .hdr", environment);
    command.option("--env-strength", "scale factor of the environment map", environment_strength);
    command.option("--env-rotation",
                   "degrees by which the environment map is turned, counter-clockwise as seen from above; at "
                   "0 its middle is +x, "
                   "as in Blender and glTF viewers",
                   environment_rotation);
    command.flag("--solid-glass",
                 "treat transmissive glTF materials without KHR_materials_volume as solid refractive glass, "
                 "not thin-walled",
                 solid_glass);
    command.choice(
        "--light-units",
        "of point, spot and directional lights in glTF: physical: candela and lux, so that 1 is a radiance "
        "of 1 at 1 m; "
        "blender: files exported by Blender, as bright as there compared with its emissive surfaces and sky "
        "(1/683)",
        light_units, {"physical", "blender"});
    command.option("--light-as-sky",
                   "leave out this light for speed, by its name in the file, and make the sky brighter by "
                   "its irradiance "
                   "instead; may be given several times",
                   lights_as_sky);
    command.flag("--soft-lights-as-sky",
                 "the same for all lights of a glTF file that have the extras {\"hard_shadow\": false}",
                 soft_lights_as_sky);
    command.option(
        "--bounces",
        "maximum path depth: diffuse and glossy scattering events after the first hit; 0 = direct light only",
        bounces);
    command.option("--specular-bounces",
                   "maximum number of reflections and refractions of a path by mirrors and smooth glass",
                   specular_bounces);
    command.option("--clamp",
                   "most that a path adds to a sample after its second bounce, per component: fewer bright "
                   "specks, but the picture "
                   "is too dark (biased) wherever light exceeds the limit (default: no limit)",
                   clamp);
    command.choice(
        "--sky-sampling",
        "light samples of sky and suns: where the surfaces in the picture see them, for rooms with "
        "windows (measured after the first 2^18 samples), or by the sky's luminance alone",
        sky_sampling, {"visible", "luminance"});
    command.choice("--pixel-filter", "pixel reconstruction filter", pixel_filter,
                   {"box", "gaussian", "blackman-harris"});
    command.choice("--renderer",
                   "path: path tracing; whitted: direct light, perfect mirrors and smooth glass only; "
                   "raster: whitted with "
                   "rasterised first hits, needs nodes with --backend vulkan; coverage: a colour per object",
                   renderer, {"path", "whitted", "raster", "coverage"});
    command.choice("--path-class", "which paths the denoiser may blur", path_class, path_class_names());
    command.choice("--feature-rule", "shading feature of the filter fdf", feature_rule,
                   {"demodulated", "connections"});
    command.flag("--transparent", "transparent background: write alpha", transparent);
}

Expected<ViewPlan> parse_options(const ViewOptions& options) {
    ViewPlan plan;
    plan.scene = options.scene;
    plan.camera = options.camera;
    const auto size = parse_size(options.size);
    if (!size) return wrong("--size", size.error());
    plan.size = *size;
    plan.import.aspect_ratio = double(size->width) / double(size->height);
    plan.view.width = size->width;
    plan.view.height = size->height;
    plan.view.window = {0, 0, static_cast<std::int32_t>(size->width),
                        static_cast<std::int32_t>(size->height)};
    if (auto fine = set_optics(options, plan); !fine) return tl::unexpected(fine.error());
    if (options.crop) {
        const auto crop = parse_crop(*options.crop, *size);
        if (!crop) return wrong("--crop", crop.error());
        plan.view.window = *crop;
    }
    if (plan.view.window.pixel_count() > MaxPixels)
        return failure(ErrorCode::InvalidInput,
                       "--size: more than 2^28 pixels; choose a smaller size, or a part with --crop");
    if (options.background) {
        const auto color = parse_color(*options.background);
        if (!color) return wrong("--background", color.error());
        plan.import.background = *color;
    }
    plan.configuration.hidden = options.hidden;
    for (const std::string& text : options.materials) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
            return failure(ErrorCode::InvalidInput, "--material: '" + text + "' is not PART=MATERIAL");
        }
        plan.configuration.materials.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
    if (auto fine = set_import(options, plan.import); !fine) return tl::unexpected(fine.error());
    plan.view.seed = options.seed;
    plan.view.max_bounces = options.bounces;
    plan.view.max_specular_bounces = options.specular_bounces;
    if (options.clamp) {
        const auto most = static_cast<float>(*options.clamp);
        if (!(most > 0.0f) || !std::isfinite(most))
            return failure(ErrorCode::InvalidInput,
                           "--clamp: '" + edit::number_text(*options.clamp) +
                               "' is not a number above 0; leave it out for no limit");
        plan.view.clamp_indirect = most;
    }
    plan.view.sky_cells_from =
        options.sky_sampling == "visible" ? view::visible_sky_from(plan.view.window) : view::NoSkyCells;
    for (const view::Renderer renderer : {view::Renderer::PathTracing, view::Renderer::Whitted,
                                          view::Renderer::Raster, view::Renderer::Coverage}) {
        if (options.renderer == view::renderer_name(renderer)) plan.view.renderer = renderer;
    }
    const auto& classes = path_class_names();
    plan.view.path_class = static_cast<view::PathClass>(
        std::find(classes.begin(), classes.end(), options.path_class) - classes.begin());
    plan.view.feature_rule = options.feature_rule == "connections" ? view::FeatureRule::Connections
                                                                   : view::FeatureRule::Demodulated;
    if (options.layers) {
        const auto layers = parse_layers(*options.layers);
        if (!layers) return wrong("--layers", layers.error());
        plan.view.layers = *layers;
    }
    plan.view.transparent_background = options.transparent;
    if (options.transparent) plan.view.channels.insert(frame::Channel::Alpha);
    plan.view.pixel_filter = pixel_filter(options.pixel_filter);
    return plan;
}

Expected<import::ImportedScene> import_scene(const ViewPlan& plan) {
    auto scene = import::import_scene(plan.scene, plan.import);
    if (!scene) return scene;
    if (auto done = import::configure(*scene, plan.configuration); !done) {
        return failure(done.error().code(), "scene '" + plan.scene + "': " + done.error().what());
    }
    return scene;
}

Expected<import::CameraInfo> choose_camera(const std::vector<import::CameraInfo>& cameras,
                                           const std::optional<std::string>& choice) {
    if (!choice) return cameras.front();
    std::vector<std::string> names;
    std::string list;
    for (const import::CameraInfo& camera : cameras) {
        if (camera.name == *choice) return camera;
        list += (list.empty() ? "" : ", ") + std::to_string(names.size()) + " '" + camera.name + "'";
        names.push_back(camera.name);
    }
    const bool is_number = !choice->empty() && choice->find_first_not_of("0123456789") == std::string::npos;
    if (is_number && choice->size() < 9 && std::stoul(*choice) < cameras.size())
        return cameras[std::stoul(*choice)];
    const auto near = nearest(*choice, names);
    return failure(ErrorCode::InvalidInput, "--camera: the scene has no camera '" + *choice + "'" +
                                                (near ? "; did you mean '" + *near + "'" : "") +
                                                "; it has: " + list);
}

view::View view_from(const ViewPlan& plan, const import::CameraInfo& camera) {
    view::View view = plan.view;
    scene::Camera values = camera.camera;
    if (plan.orthographic_height) {
        values.projection = scene::Projection::Orthographic;
        values.orthographic_height = *plan.orthographic_height;
    }
    values.lens_radius = plan.lens_radius.value_or(values.lens_radius);
    values.focus_distance = plan.focus_distance.value_or(values.focus_distance);
    values.aperture = plan.aperture.value_or(values.aperture);
    view.camera =
        view::pose(values, camera.world_from_camera, double(plan.size.width) / double(plan.size.height));
    view.camera.motion = camera.motion;
    return view;
}

}  // namespace tessera::tools
