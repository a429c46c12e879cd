#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "mediator/base/description.h"
#include "mediator/base/ids.h"
#include "mediator/base/rect.h"
#include "mediator/frame/channels.h"
#include "mediator/scene/objects.h"

namespace tessera::view {

// The frustum: edges of the picture at distance 1 in front of the eye, off-axis in general; in metres for an
// orthographic camera. A thin lens is a disk around the eye, or around the origin of each orthographic ray,
// perpendicular to the axis; the focal plane is at focus_distance along the axis.
struct CameraPose {
    glm::dmat4 world_from_camera{1.0};  // rigid; camera looks along -z, y up
    double left = -1.0, right = 1.0, bottom = -1.0, top = 1.0;
    scene::Projection projection = scene::Projection::Perspective;
    double lens_radius = 0.0;  // m; 0 = a pinhole
    double focus_distance = 1.0;
    scene::Aperture aperture = scene::Aperture::Uniform;
    // Motion keys of world_from_camera, as scene::Transform::motion.
    std::vector<glm::dmat4> motion;

    glm::dvec4 edges() const { return {left, right, bottom, top}; }
    void set_edges(const glm::dvec4& edges) {
        left = edges.x;
        right = edges.y;
        bottom = edges.z;
        top = edges.w;
    }
    bool is_pinhole() const { return projection == scene::Projection::Perspective && !(lens_radius > 0.0); }
    friend bool operator==(const CameraPose&, const CameraPose&) = default;
};

CameraPose perspective(const glm::dmat4& world_from_camera, double vertical_fov, double aspect_ratio);

// The pose of a Camera object, for this aspect ratio instead of its own.
CameraPose pose(const scene::Camera& camera, const glm::dmat4& world_from_camera, double aspect_ratio);

enum class Eye : std::uint8_t { Mono, Left, Right };
constexpr auto enumerators(Eye) {
    return std::to_array<std::string_view>({"mono", "left", "right"});
}
enum class PixelFilterKind : std::uint8_t { Box, Gaussian, BlackmanHarris };
constexpr auto enumerators(PixelFilterKind) {
    return std::to_array<std::string_view>({"box", "gaussian", "blackman-harris"});
}

// By filter importance sampling: a sample contributes to one pixel. Radius in pixels: box 0.5; gaussian 1.5 (sigma =
// radius / 3); Blackman-Harris 1.5.
struct PixelFilter {
    PixelFilterKind kind = PixelFilterKind::Box;
    float radius = 0.5f;
    friend bool operator==(const PixelFilter&, const PixelFilter&) = default;
};

enum class Renderer : std::uint8_t {
    PathTracing,
    Whitted,  // direct light and all branches of perfect specular reflection and refraction (Whitted 1980)
    Raster,  // the same with rasterised first hits, for navigation; a sample has the same subpixel position in all
             // pixels. Views with an orthographic camera, a lens or camera motion use Whitted instead
    Coverage,  // first hits in one unlit colour per object (Schwenk 5.4.3)
};
constexpr auto enumerators(Renderer) {
    return std::to_array<std::string_view>({"path", "whitted", "raster", "coverage"});
}

// The name for --renderer: "path", "whitted", "raster", "coverage".
std::string_view renderer_name(Renderer renderer);

class RendererSet {
  public:
    constexpr RendererSet() = default;
    constexpr RendererSet(std::initializer_list<Renderer> renderers) {
        for (const Renderer renderer : renderers) bits_ |= bit(renderer);
    }
    static constexpr RendererSet from_bits(std::uint32_t bits) {
        RendererSet set;
        set.bits_ = bits & (bit(Renderer::Coverage) * 2u - 1u);
        return set;
    }
    constexpr std::uint32_t bits() const { return bits_; }
    constexpr bool contains(Renderer renderer) const { return (bits_ & bit(renderer)) != 0; }
    constexpr void insert(Renderer renderer) { bits_ |= bit(renderer); }
    friend constexpr bool operator==(RendererSet, RendererSet) = default;

  private:
    static constexpr std::uint32_t bit(Renderer renderer) { return 1u << static_cast<unsigned>(renderer); }
    std::uint32_t bits_ = 0;
};

// The renderers of every back-end that traces rays.
inline constexpr RendererSet TracingRenderers{Renderer::PathTracing, Renderer::Whitted, Renderer::Coverage};

// Which paths contribute to the channel HighVariance (Schwenk 3.3). Scattering events count from the first non-delta
// hit on.
enum class PathClass : std::uint8_t {
    Indirect,  // more than one scattering event from the first non-delta hit on
    Caustics,  // the last scattering event before the light is perfectly specular, after the first non-delta hit
    Diffuse,  // light of the diffuse lobe at the first non-delta hit
    All,
    None,
};
constexpr auto enumerators(PathClass) {
    return std::to_array<std::string_view>({"indirect", "caustics", "diffuse", "all", "none"});
}

// What a sample adds to the shading feature (Lardinoije 4.2).
enum class FeatureRule : std::uint8_t {
    Demodulated,  // grey of the diffuse irradiance plus the radiance of other lobes
    Connections,  // grey of the intensity of each light found by next event estimation or by the path itself
};
constexpr auto enumerators(FeatureRule) {
    return std::to_array<std::string_view>({"demodulated", "connections"});
}

inline constexpr std::uint32_t UnlimitedBounces = std::numeric_limits<std::uint32_t>::max();

inline constexpr std::uint32_t NoSkyCells = std::numeric_limits<std::uint32_t>::max();

// View::sky_cells_from of a picture of this part, by default. Measuring where the sky is seen takes a node as long as about
// 2^17 samples (mediator/backend/sky_cells.h), so it waits for twice as many.
constexpr std::uint32_t visible_sky_from(const Rect& window) {
    constexpr std::size_t Samples = std::size_t{1} << 18;
    const std::size_t pixels = window.pixel_count();
    return pixels == 0 ? NoSkyCells : static_cast<std::uint32_t>((Samples + pixels - 1) / pixels);
}

inline constexpr std::uint32_t AllLayers = 0xffffffff;  // object layers: bit i is layer i

// What to render, by value: a sample is a pure function of (scene content, view, pixel, sample index). A new revision
// invalidates the film. Moving the camera makes a new revision, never a new scene version.
struct View {
    ViewId id;
    std::uint64_t revision = 1;
    CameraPose camera;
    Eye eye = Eye::Mono;
    std::uint32_t width = 1280, height = 720;  // of the whole picture
    Rect window{0, 0, 1280, 720};              // the part that is rendered (crop)
    std::uint64_t seed = 0;
    std::uint32_t max_bounces = 8;            // diffuse and glossy ones, and in media; 0 = direct light only
    std::uint32_t max_specular_bounces = 32;  // perfect reflections and refractions
    float clamp_indirect =
        0.0f;  // most of a component that a path adds after its second bounce; 0 = no limit
    // The first sample that samples the sky where it is seen (mediator/shading/sky_cells.h).
    std::uint32_t sky_cells_from = NoSkyCells;
    PixelFilter pixel_filter;
    Renderer renderer = Renderer::PathTracing;
    PathClass path_class = PathClass::Indirect;
    FeatureRule feature_rule = FeatureRule::Demodulated;
    bool transparent_background = false;  // camera rays that miss have no radiance and alpha 0
    std::uint32_t layers = AllLayers;     // object layers; all others do not exist for this view
    frame::ChannelSet channels;
    std::string filter;  // denoiser as NAME[:key=value,...], run on the master; empty = none
    friend bool operator==(const View&, const View&) = default;
    static constexpr auto describe(auto row) {
        constexpr auto camera = [](auto member) {
            return [member](auto& view) -> auto& {
                return view.camera.*member;
            };
        };
        constexpr auto pixels = [](auto member) {
            return [member](auto& view) -> auto& {
                return view.pixel_filter.*member;
            };
        };
        constexpr auto channels = [](std::size_t word) {
            return [word](auto& view) -> auto& {
                return view.channels.words()[word];
            };
        };
        constexpr Computed frustum{[](const View& view) { return view.camera.edges(); },
                                   [](View& view, const glm::dvec4& edges) { view.camera.set_edges(edges); }};
        constexpr Computed hidden{[](const View& view) { return ~view.layers; },
                                  [](View& view, std::uint32_t layers) { view.layers = ~layers; }};
        return std::tuple(
            row(1, "id", &View::id), row(2, "revision", &View::revision),
            row(3, "world_from_camera", camera(&CameraPose::world_from_camera)), row(4, "frustum", frustum),
            row(5, "eye", &View::eye), row(6, "width", &View::width), row(7, "height", &View::height),
            row(8, "window", &View::window), row(9, "seed", &View::seed),
            row(10, "max_bounces", &View::max_bounces), row(11, "pixel_filter", pixels(&PixelFilter::kind)),
            row(12, "filter_radius", pixels(&PixelFilter::radius)), row(13, "channels", channels(0)),
            row(14, "renderer", &View::renderer), row(15, "path_class", &View::path_class),
            row(16, "feature_rule", &View::feature_rule),
            row(17, "transparent_background", &View::transparent_background),
            row(18, "filter", &View::filter), row(19, "hidden_layers", hidden),
            row(20, "projection", camera(&CameraPose::projection)),
            row(21, "lens_radius", camera(&CameraPose::lens_radius)),
            row(22, "focus_distance", camera(&CameraPose::focus_distance)),
            row(23, "aperture", camera(&CameraPose::aperture)),
            row(24, "camera_motion", camera(&CameraPose::motion), Limit{scene::MaxDecodedMotion}),
            row(25, "later_channels", channels(1)),
            row(26, "max_specular_bounces", &View::max_specular_bounces, InitialWhenAbsent{}),
            row(27, "clamp_indirect", &View::clamp_indirect),
            row(28, "sky_cells_from", &View::sky_cells_from, InitialWhenAbsent{}));
    }
    const char* malformed() const {
        // Also of NaN.
        if (!(clamp_indirect >= 0.0f)) return "clamp_indirect is not a number from 0 on";
        return channels.not_renderable();
    }
};

}  // namespace tessera::view
