#pragma once

#include <array>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "mediator/base/description.h"
#include "mediator/scene/blob.h"
#include "mediator/view/display_transform.h"
#include "mediator/view/view.h"

// Displays: screens in space, and outputs, each the picture of one device. Plain
// values. Display space: metres, right-handed, y up; origin and axes are those of the scene camera that
// carries the display, so a wall two metres in front of it has z = -2.
namespace tessera::display {

// Larger displays are rejected.
inline constexpr std::size_t MaxOutputs = 64, MaxLayers = 4, MaxHull = 4096, MaxCurve = 4096;
inline constexpr std::uint32_t MaxEdge = 16384;

// How an output shows the two eyes.
enum class Stereo : std::uint8_t {
    Mono,  // one picture, seen from between the eyes
    Left,  // this eye only: the other has its own output
    Right,
    Separate,        // two pictures of the full size: files
    SideBySide,      // left eye in the left half, each squeezed to half the width
    TopBottom,       // left eye in the upper half
    InterlacedRows,  // even rows of the desktop show the left eye
    AnaglyphPlain,   // red of the left eye, green and blue of the right
    AnaglyphDubois,  // least-squares red-cyan (Dubois 2001)
};
constexpr auto enumerators(Stereo) {
    return std::to_array<std::string_view>({"mono", "left", "right", "separate", "side-by-side", "top-bottom",
                                            "rows", "anaglyph-plain", "anaglyph"});
}

// Clockwise rotation of the mounted device; its picture is rotated the other way.
enum class Turn : std::uint8_t { None, Quarter, Half, ThreeQuarters };
constexpr auto enumerators(Turn) {
    return std::to_array<std::string_view>({"none", "quarter", "half", "three-quarters"});
}

// Values over an output's picture, float32, row by row from the top left, bilinear in between.
struct Grid {
    enum class Nodes : std::uint8_t {
        Edges,   // node (i, j) is at (i / (columns - 1), j / (rows - 1)) of the picture
        Centres  // at ((i + 0.5) / columns, (j + 0.5) / rows): one a pixel, for example
    };
    friend constexpr auto enumerators(Nodes) { return std::to_array<std::string_view>({"edges", "centres"}); }
    std::uint32_t columns = 0, rows = 0, components = 1;
    Nodes nodes = Nodes::Edges;
    scene::BlobRef values;  // columns x rows x components
    bool empty() const { return values.empty(); }
    friend bool operator==(const Grid&, const Grid&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "columns", &Grid::columns), row(2, "rows", &Grid::rows),
                          row(3, "components", &Grid::components), row(4, "nodes", &Grid::nodes),
                          row(5, "values", &Grid::values));
    }
};

// The flat plane that an output's view is rendered for. The picture is the bounding box, along `right` and
// `up`, of the hull as it is seen from the eye.
struct ProjectionPlane {
    glm::dvec3 origin{0.0, 0.0, -1.0};                   // any point of the plane
    glm::dvec3 right{1.0, 0.0, 0.0}, up{0.0, 1.0, 0.0};  // unit, orthogonal; eyes are where right x up points
    std::vector<glm::dvec3> hull;  // of the visible points; of a flat wall: its four corners
    friend bool operator==(const ProjectionPlane&, const ProjectionPlane&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "origin", &ProjectionPlane::origin),
                          row(2, "right", &ProjectionPlane::right), row(3, "up", &ProjectionPlane::up),
                          row(4, "hull", &ProjectionPlane::hull, Limit{MaxHull}));
    }
};

// Where pictures of several projectors overlap. All in linear light.
struct Blend {
    // Soft edges: the weight rises from 0 to 1 over so many pixels from each edge, as f(t) = (2t)^shape / 2
    // below one half and 1 - f(1 - t) above, so that two ramps that meet add up to 1.
    double left = 0, right = 0, top = 0, bottom = 0;
    double shape = 1.0;
    Grid weights;  // 1 component in [0, 1], instead of ramps
    // Black-level lift: added (1 component, in [0, 1) of full white) where fewer projectors overlap than
    // elsewhere; a pixel shows lift + (1 - lift) x value.
    Grid lift;
    friend bool operator==(const Blend&, const Blend&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "left", &Blend::left), row(2, "right", &Blend::right),
                          row(3, "top", &Blend::top), row(4, "bottom", &Blend::bottom),
                          row(5, "shape", &Blend::shape), row(6, "weights", &Blend::weights),
                          row(7, "lift", &Blend::lift));
    }
};

// From linear light to device values: matrix, gain, then curve or gamma.
struct Color {
    glm::dmat3 matrix{1.0};  // device rgb from linear Rec. 709
    glm::dvec3 gain{1.0};
    double gamma = 0.0;        // 0 = the curve of sRGB
    std::vector<float> curve;  // device value at linear 0 ... 1, evenly spaced; empty = gamma
    friend bool operator==(const Color&, const Color&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "matrix", &Color::matrix), row(2, "gain", &Color::gain),
                          row(3, "gamma", &Color::gamma), row(4, "curve", &Color::curve, Limit{MaxCurve}));
    }
};

struct Output {
    std::string name;
    std::uint32_t width = 1920, height = 1080;  // pixels of the device
    std::int32_t x = 0, y = 0;                  // of its top left pixel on the desktop
    Turn turn = Turn::None;
    Stereo stereo = Stereo::Mono;
    std::uint32_t priority = 1;  // 1, 2, 4 or 8: samples per pixel, relative to other outputs
    ProjectionPlane plane;
    std::uint32_t view_width = 1920, view_height = 1080;  // of the picture rendered for each eye
    Grid points;  // 3 components: where on the screen the device's pixels are seen; empty = the plane's box
    Blend blend;
    Color color;
    friend bool operator==(const Output&, const Output&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &Output::name), row(2, "width", &Output::width),
                          row(3, "height", &Output::height), row(4, "x", &Output::x), row(5, "y", &Output::y),
                          row(6, "turn", &Output::turn), row(7, "stereo", &Output::stereo),
                          row(8, "priority", &Output::priority), row(9, "plane", &Output::plane),
                          row(10, "view_width", &Output::view_width),
                          row(11, "view_height", &Output::view_height), row(12, "points", &Output::points),
                          row(13, "blend", &Output::blend), row(14, "color", &Output::color));
    }
};

// A compositing layer: layers are composed by depth and alpha (Schwenk 5.3.2).
struct Layer {
    std::string name;
    view::Renderer renderer = view::Renderer::PathTracing;
    std::uint32_t layers = 0xffffffffu;  // bit mask of the object layers that it shows
    bool shown = true;
    friend bool operator==(const Layer&, const Layer&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &Layer::name), row(2, "renderer", &Layer::renderer),
                          row(3, "layers", &Layer::layers), row(4, "shown", &Layer::shown));
    }
};

// The viewer's head, at rest or tracked.
struct Head {
    glm::dvec3 position{0.0};                    // between the eyes
    glm::dquat orientation{1.0, 0.0, 0.0, 0.0};  // (w, x, y, z), unit; identity looks along -z
    friend bool operator==(const Head&, const Head&) = default;
    // The orientation is normalized when decoded, so rounding errors do not accumulate.
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "position", &Head::position),
                          row(2, "orientation",
                              Computed{[](const Head& head) { return head.wxyz(); },
                                       [](Head& head, const glm::dvec4& wxyz) { head.turn(wxyz); }}));
    }
    const char* malformed() const;
    glm::dvec4 wxyz() const { return {orientation.w, orientation.x, orientation.y, orientation.z}; }
    void turn(const glm::dvec4& wxyz);  // close to a unit quaternion; otherwise malformed() reports it
};

struct Display {
    std::string name;
    std::string camera;            // of the scene, carries the display; "" = its first camera
    double units_per_metre = 1.0;  // of the scene
    Head head;
    double eye_separation = 0.064;  // metres
    double zero_parallax = 0.0;     // metres from the head; 0 = on the screens
    std::uint64_t spp = 256;        // of outputs with priority 1
    std::uint32_t coarsest = 8;     // 8, 4, 2: the first picture after a change has 1/coarsest of the size
    std::uint32_t max_bounces = 8;
    double rate = 60.0;     // frames a second, at most
    std::string filter;     // NAME[:key=value,...]
    double exposure = 0.0;  // EV; the same for all outputs, so that there are no seams
    view::ViewTransform view_transform = view::ViewTransform::Linear;  // also for all outputs
    double white = 0.0;  // of the view transform reinhard: the luminance that becomes 1; 0 = 4
    bool stereo_difference =
        false;                  // measure the consistency of both eyes' pictures (needs the depth channel)
    std::vector<Layer> layers;  // empty: one path-traced layer of everything
    std::vector<Output> outputs;
    friend bool operator==(const Display&, const Display&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "name", &Display::name), row(2, "camera", &Display::camera),
            row(3, "units_per_metre", &Display::units_per_metre), row(4, "head", &Display::head),
            row(5, "eye_separation", &Display::eye_separation),
            row(6, "zero_parallax", &Display::zero_parallax), row(7, "spp", &Display::spp),
            row(8, "coarsest", &Display::coarsest), row(9, "max_bounces", &Display::max_bounces),
            row(10, "rate", &Display::rate), row(11, "filter", &Display::filter),
            row(12, "layers", &Display::layers, Limit{MaxLayers}),
            row(13, "outputs", &Display::outputs, Limit{MaxOutputs}), row(14, "exposure", &Display::exposure),
            row(15, "white", &Display::white), row(16, "stereo_difference", &Display::stereo_difference),
            row(17, "view_transform", &Display::view_transform, InitialWhenAbsent{}));
    }
};

// Whether an output client needs linear light, since it warps, blends or corrects colour. Otherwise it is sent device
// values.
bool takes_linear_light(const Output& output);

// Whether the position is finite and within 1000 km of the display's origin.
bool has_valid_position(const Head& head);

}  // namespace tessera::display
