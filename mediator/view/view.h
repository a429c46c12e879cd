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

// Edges of the picture at distance 1 in front of the eye, so off-axis is the normal case; of an orthographic
// one in metres. A thin lens is a disk around the eye, or around each orthographic ray's start, across the
// axis; what lies in the plane at focus_distance along the axis is sharp.
struct CameraPose {
    glm::dmat4 world_from_camera{1.0};  // rigid; camera looks along -z, y up
    double left = -1.0, right = 1.0, bottom = -1.0, top = 1.0;
    scene::Projection projection = scene::Projection::Perspective;
    double lens_radius = 0.0;  // m; 0 = a pinhole
    double focus_distance = 1.0;
    scene::Aperture aperture = scene::Aperture::Uniform;
    // As scene::Transform::motion: world_from_camera at even steps of time, each element in a straight line.
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

// As a Camera object sees, in a picture of this aspect ratio, whatever its own is.
CameraPose pose(const scene::Camera& camera, const glm::dmat4& world_from_camera, double aspect_ratio);

enum class Eye : std::uint8_t { Mono, Left, Right };
constexpr auto enumerators(Eye) {
    return std::to_array<std::string_view>({"mono", "left", "right"});
}
enum class PixelFilterKind : std::uint8_t { Box, Gaussian, BlackmanHarris };
constexpr auto enumerators(PixelFilterKind) {
    return std::to_array<std::string_view>({"box", "gaussian", "blackman-harris"});
}

// Done by filter importance sampling: a sample counts for its own pixel alone. Radius in pixels: box 0.5;
// gaussian 1.5 (sigma = radius / 3); Blackman-Harris 1.5.
struct PixelFilter {
    PixelFilterKind kind = PixelFilterKind::Box;
    float radius = 0.5f;
    friend bool operator==(const PixelFilter&, const PixelFilter&) = default;
};

enum class Renderer : std::uint8_t {
    PathTracing,
    Whitted,   // direct light and perfect speculars, every branch of them followed (Whitted 1980)
    Raster,    // the same from first hits of a rasteriser, for navigation; all pixels of a sample share their
               // place in the pixel. Orthographic views, views through a lens and what moves while the
               // shutter is open find theirs by rays, as Whitted
    Coverage,  // what the camera sees first of which object, in a colour for each, unlit (Schwenk 5.4.3)
};
constexpr auto enumerators(Renderer) {
    return std::to_array<std::string_view>({"path", "whitted", "raster", "coverage"});
}

// As --renderer has it: "path", "whitted", "raster", "coverage".
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

// Of every back-end that traces rays.
inline constexpr RendererSet TracingRenderers{Renderer::PathTracing, Renderer::Whitted, Renderer::Coverage};

// Which paths go to the channel HighVariance (Schwenk 3.3). A path's scatterings are counted from the eye;
// perfect speculars in front of the first other hit only show it somewhere else.
enum class PathClass : std::uint8_t {
    Indirect,  // more than one scattering from the first non-delta hit on
    Caustics,  // the last scattering before the light is a perfect specular behind the first non-delta hit
    Diffuse,   // light of the diffuse lobe at the first non-delta hit
    All,
    None,
};
constexpr auto enumerators(PathClass) {
    return std::to_array<std::string_view>({"indirect", "caustics", "diffuse", "all", "none"});
}

// What a sample adds to the shading feature, which was defined for paths that end at a light
// (Lardinoije 4.2).
enum class FeatureRule : std::uint8_t {
    Demodulated,  // grey of the diffuse irradiance, and of all light of other lobes
    Connections,  // grey of the intensity of each light that next-event estimation or the path itself reaches
};
constexpr auto enumerators(FeatureRule) {
    return std::to_array<std::string_view>({"demodulated", "connections"});
}

inline constexpr std::uint32_t UnlimitedBounces = std::numeric_limits<std::uint32_t>::max();

inline constexpr std::uint32_t AllLayers = 0xffffffff;  // of objects: bit i is layer i

// What to render, by value: a sample is a pure function of (scene content, view, pixel, sample index).
// A new revision means: old film is of no use. A moved camera is a revision, never a scene version.
struct View {
    ViewId id;
    std::uint64_t revision = 1;
    CameraPose camera;
    Eye eye = Eye::Mono;
    std::uint32_t width = 1280, height = 720;  // of the whole picture
    Rect window{0, 0, 1280, 720};              // the part that is rendered (crop)
    std::uint64_t seed = 0;
    std::uint32_t max_bounces = 8;  // as in Cycles: 0 = direct light only
    PixelFilter pixel_filter;
    Renderer renderer = Renderer::PathTracing;
    PathClass path_class = PathClass::Indirect;
    FeatureRule feature_rule = FeatureRule::Demodulated;
    bool transparent_background = false;  // camera rays that leave the scene bring no light (alpha 0)
    std::uint32_t layers = AllLayers;     // for its rays and its light there is nothing else
    frame::ChannelSet channels;
    std::string filter;  // NAME[:key=value,...] of the reconstruction, done on the master; empty = none
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
            row(25, "later_channels", channels(1)));
    }
    const char* malformed() const { return channels.is_known() ? nullptr : "a channel is unknown"; }
};

}  // namespace tessera::view
