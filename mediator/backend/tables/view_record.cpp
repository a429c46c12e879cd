#include "mediator/backend/tables/view_record.h"

#include "mediator/shading/containing_media.h"
#include "mediator/shading/sample_values.h"

namespace tessera::backend {

namespace {

using frame::Channel;

// The enumerators of the view are used in the records unchanged.
static_assert(shading::FilterBox == std::uint32_t(view::PixelFilterKind::Box) &&
              shading::FilterGaussian == std::uint32_t(view::PixelFilterKind::Gaussian) &&
              shading::FilterBlackmanHarris == std::uint32_t(view::PixelFilterKind::BlackmanHarris));
static_assert(shading::RendererPathTracing == std::uint32_t(view::Renderer::PathTracing) &&
              shading::RendererWhitted == std::uint32_t(view::Renderer::Whitted) &&
              shading::RendererRaster == std::uint32_t(view::Renderer::Raster) &&
              shading::RendererObjectId == std::uint32_t(view::Renderer::Coverage));
static_assert(shading::ClassIndirect == std::uint32_t(view::PathClass::Indirect) &&
              shading::ClassCaustics == std::uint32_t(view::PathClass::Caustics) &&
              shading::ClassDiffuse == std::uint32_t(view::PathClass::Diffuse) &&
              shading::ClassAll == std::uint32_t(view::PathClass::All) &&
              shading::ClassNone == std::uint32_t(view::PathClass::None));
static_assert(shading::RuleDemodulated == std::uint32_t(view::FeatureRule::Demodulated) &&
              shading::RuleConnections == std::uint32_t(view::FeatureRule::Connections));

constexpr bool is_number_of(std::uint32_t number, Channel channel) {
    return number == static_cast<std::uint32_t>(channel);
}
static_assert(is_number_of(shading::ChannelRadiance, Channel::Radiance) &&
              is_number_of(shading::ChannelLowVariance, Channel::LowVariance) &&
              is_number_of(shading::ChannelHighVariance, Channel::HighVariance) &&
              is_number_of(shading::ChannelAlbedo, Channel::Albedo) &&
              is_number_of(shading::ChannelNormal, Channel::Normal) &&
              is_number_of(shading::ChannelDepth, Channel::Depth) &&
              is_number_of(shading::ChannelObjectIndex, Channel::ObjectIndex) &&
              is_number_of(shading::ChannelAlpha, Channel::Alpha) &&
              is_number_of(shading::ChannelHeadlight, Channel::Headlight) &&
              is_number_of(shading::ChannelShadingFeature, Channel::ShadingFeature) &&
              is_number_of(shading::ChannelIrradiance, Channel::Irradiance) &&
              is_number_of(shading::ChannelColor, Channel::Color) &&
              is_number_of(shading::ChannelRoot, Channel::Root) && frame::ChannelCount == 16);

std::uint32_t recorded_quantities(const view::View& view) {
    const bool feature = view.channels.contains(Channel::ShadingFeature);
    std::uint32_t recorded = 0;
    if (view.path_class == view::PathClass::Diffuse || view.channels.contains(Channel::Irradiance) ||
        (feature && view.feature_rule == view::FeatureRule::Demodulated)) {
        recorded |= shading::RecordsDiffuse;
    }
    if (feature && view.feature_rule == view::FeatureRule::Connections)
        recorded |= shading::RecordsConnections;
    if (view.channels.contains(Channel::Headlight)) recorded |= shading::RecordsHeadlight;
    return recorded;
}

std::uint32_t camera_bits(const view::CameraPose& camera) {
    std::uint32_t bits = shading::CameraPinhole;
    if (camera.projection == scene::Projection::Orthographic) bits |= shading::CameraOrthographic;
    if (!(camera.lens_radius > 0.0)) return bits;
    bits |= shading::CameraLens;
    if (camera.aperture == scene::Aperture::Gaussian) bits |= shading::CameraGaussian;
    return bits;
}

// Raster needs a static pinhole camera; other views use Whitted.
view::Renderer renderer_of(const view::View& view) {
    const bool is_raster = view.renderer == view::Renderer::Raster;
    return is_raster && (!view.camera.is_pinhole() || !view.camera.motion.empty()) ? view::Renderer::Whitted
                                                                                   : view.renderer;
}

}  // namespace

shading::View make_view(const view::View& view, const glm::dvec3& render_origin) {
    const view::CameraPose& camera = view.camera;
    const glm::dmat4& m = camera.world_from_camera;
    return {
        .seed = view.seed,
        .eye = glm::vec3(glm::dvec3(m[3]) - render_origin),
        .right = glm::vec3(m[0]),
        .up = glm::vec3(m[1]),
        .forward = -glm::vec3(m[2]),
        .image_center = {static_cast<float>(0.5 * (camera.left + camera.right)),
                         static_cast<float>(0.5 * (camera.top + camera.bottom))},
        .step = {static_cast<float>((camera.right - camera.left) / view.width),
                 static_cast<float>((camera.bottom - camera.top) / view.height)},
        .width = view.width,
        .height = view.height,
        .pixel_filter = static_cast<std::uint32_t>(view.pixel_filter.kind),
        .filter_radius = view.pixel_filter.radius,
        // Paths have up to max_bounces + 1 scattering events that are not perfect speculars, so 0 is direct light.
        .max_scatter_events = view.max_bounces == view::UnlimitedBounces ? shading::UnlimitedScatterEvents
                                                                         : view.max_bounces + 1,
        .renderer = static_cast<std::uint32_t>(renderer_of(view)),
        .path_class = static_cast<std::uint32_t>(view.path_class),
        .feature_rule = static_cast<std::uint32_t>(view.feature_rule),
        .channels = view.channels.kernel_bits(),
        .recorded_quantities = recorded_quantities(view),
        .transparent_background = view.transparent_background ? 1u : 0u,
        .strategy = shading::StrategyBoth,
        .layers = view.layers,
        .camera = camera_bits(camera),
        .lens_radius = static_cast<float>(camera.lens_radius),
        .focus_distance = static_cast<float>(camera.focus_distance),
        .camera_keys = {},
        .camera_key_intervals = static_cast<std::uint32_t>(camera.motion.size()),
        .containing_media = shading::no_media(),
        .max_specular_events = view.max_specular_bounces,
        .clamp_indirect = view.clamp_indirect,
        .sky_cells_from = shading::NoSkyCells};
}

std::vector<shading::Affine3x4> camera_keys(const view::CameraPose& camera, const glm::dvec3& render_origin) {
    std::vector<shading::Affine3x4> places;
    if (camera.motion.empty()) return places;
    const auto add = [&](const glm::dmat4& world_from_camera) {
        places.push_back({.linear = glm::mat3(glm::dmat3(world_from_camera)),
                          .translation = glm::vec3(glm::dvec3(world_from_camera[3]) - render_origin)});
    };
    add(camera.world_from_camera);
    for (const glm::dmat4& step : camera.motion) add(step);
    return places;
}

}  // namespace tessera::backend
