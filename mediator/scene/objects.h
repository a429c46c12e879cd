#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "mediator/base/ids.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/field_notes.h"
#include "mediator/scene/materials.h"

// The minimal set of scene objects (Schwenk 5.3.2.1). Plain values; `describe` has one row for each field,
// and everything that treats fields alike is derived from it: masks, validation, comparison, hashing, the
// wire, the edit language, Python. Metres, radians, linear Rec. 709; world right-handed, y up.
namespace tessera::scene {

// How often a geometry is going to move (Schwenk 5.4.1): static is built for tracing, animated for updating,
// unflagged starts as static and changes over at its first move.
enum class MotionHint : std::uint8_t { Unflagged, Static, Animated };
constexpr auto enumerators(MotionHint) {
    return std::to_array<std::string_view>({"unflagged", "static", "animated"});
}

// Steps of motion that an object may have after its first.
inline constexpr std::size_t MaxMotion = 15;
// Longer lists are not decoded; validation allows much less motion and its message says more.
inline constexpr std::size_t MaxDecodedMotion = 256, MaxChildren = 16'000'000;
inline constexpr Limit DecodedMotion{MaxDecodedMotion}, DecodedChildren{MaxChildren};

// The graph's inner node. Children may be transforms, geometries, lights, cameras and attachments; shared
// children are instances. No cycles. Layers (Schwenk F55) are for views to leave out: an object is in those
// of the nearest transform above it that names some, else in RootLayers.
struct Transform {
    static constexpr KindRow Kind{ObjectKind::Transform, "transform", "transforms"};
    std::string name;
    glm::dmat4 matrix{1.0};
    std::vector<ObjectId> children;
    MotionHint hint = MotionHint::Unflagged;
    std::uint32_t layers = 0;
    // While the shutter is open: matrices at even steps of time after `matrix`, the last when it closes;
    // between them each element goes in a straight line. Empty: it stands still.
    std::vector<glm::dmat4> motion;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Transform;
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "matrix", &T::matrix, About{"parent from local, affine"}),
            row(3, "children", &T::children, Refers{PlacedKinds}, DecodedChildren),
            row(4, "hint", &T::hint),
            row(5, "layers", &T::layers, About{"bit i: what hangs below is in layer i; 0 = as the parent says"}),
            row(6, "motion", &T::motion, Longest{MaxMotion}, DecodedMotion, About{"at even steps of time after matrix, until the shutter closes"}));
    }
    // clang-format on
};

// Indexed triangles. Arrays are blobs; empty = not there.
struct Geometry {
    static constexpr KindRow Kind{ObjectKind::Geometry, "geometry", "geometries"};
    std::string name;
    ObjectId material;
    MotionHint hint = MotionHint::Unflagged;
    BlobRef indices;
    BlobRef positions;
    BlobRef normals;
    BlobRef tangents;
    BlobRef tex_coords;
    BlobRef colors;
    BlobRef tex_coords_1;
    ObjectId medium;
    std::vector<BlobRef> motion_positions, motion_normals;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Geometry;
        constexpr auto of_vertex = [](unsigned components) { return Array{Element::Float32, components, true}; };
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "material", &T::material, Refers{bit(ObjectKind::Material) | bit(ObjectKind::SurfaceShader)}, About{"0 = the default grey"}),
            row(3, "hint", &T::hint),
            row(4, "indices", &T::indices, Array{Element::Uint32, 3}, About{"of a triangle"}),
            row(5, "positions", &T::positions, of_vertex(3)),
            row(6, "normals", &T::normals, of_vertex(3)),
            row(7, "tangents", &T::tangents, of_vertex(4), About{"w = handedness"}),
            row(8, "tex_coords", &T::tex_coords, of_vertex(2), About{"v down as in glTF"}),
            row(9, "colors", &T::colors, of_vertex(4), About{"linear"}),
            row(10, "tex_coords_1", &T::tex_coords_1, of_vertex(2)),
            row(11, "medium", &T::medium, Refers{bit(ObjectKind::Medium)}, About{"what its body is filled with; 0 = nothing"}),
            row(12, "motion_positions", &T::motion_positions, of_vertex(3), Longest{MaxMotion}, DecodedMotion, About{"at even steps of time after positions"}),
            row(13, "motion_normals", &T::motion_normals, of_vertex(3), Longest{MaxMotion}, DecodedMotion, About{"none: normals stay; or as many as motion_positions"}));
    }
    // clang-format on
};

enum class TexelFormat : std::uint8_t { Rgba8, Rgba8Srgb, RgbFloat };
constexpr auto enumerators(TexelFormat) {
    return std::to_array<std::string_view>({"rgba8", "rgba8_srgb", "rgb_float"});
}
enum class Wrap : std::uint8_t { Repeat, Mirror, Clamp };
constexpr auto enumerators(Wrap) {
    return std::to_array<std::string_view>({"repeat", "mirror", "clamp"});
}
enum class TextureFilter : std::uint8_t { Linear, Nearest };
constexpr auto enumerators(TextureFilter) {
    return std::to_array<std::string_view>({"linear", "nearest"});
}

// Decoded texels; decoding is the client's work, a node never parses image files.
struct Texture {
    static constexpr KindRow Kind{ObjectKind::Texture, "texture", "textures"};
    std::string name;
    std::uint32_t width = 0, height = 0;
    TexelFormat format = TexelFormat::Rgba8;
    Wrap wrap_s = Wrap::Repeat, wrap_t = Wrap::Repeat;
    TextureFilter filter = TextureFilter::Linear;
    BlobRef texels;
    std::uint32_t depth = 1;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Texture;
        constexpr Range Edge{1, 65536};
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "width", &T::width, Edge),
            row(3, "height", &T::height, Edge),
            row(4, "format", &T::format),
            row(5, "wrap_s", &T::wrap_s),
            row(6, "wrap_t", &T::wrap_t),
            row(7, "filter", &T::filter),
            row(8, "texels", &T::texels, Array{Element::Byte, 1}, About{"rows from the top, slices one after the other"}),
            row(9, "depth", &T::depth, Edge, About{"slices; only media read more than the first"}));
    }
    // clang-format on
};

enum class LightKind : std::uint8_t { Point, Spot, Directional, Sphere, Quad };
constexpr auto enumerators(LightKind) {
    return std::to_array<std::string_view>({"point", "spot", "directional", "sphere", "quad"});
}

// KHR_lights_punctual, in the frame of its parent transform: shines along -z; only its place and direction
// count, not its scale. Spheres and quads can be seen and do not block light; emissive geometry is a light,
// too.
struct Light {
    static constexpr KindRow Kind{ObjectKind::Light, "light", "lights"};
    std::string name;
    LightKind kind = LightKind::Point;
    glm::vec3 intensity{1.0f};
    float inner_cone_angle = 0.0f;
    float outer_cone_angle = 0.785398163397f;  // pi / 4
    float radius = 0.1f;
    glm::vec2 size{1.0f};
    float angle = 0.0f;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Light;
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "kind", &T::kind),
            row(3, "intensity", &T::intensity, NotNegative, About{"W/sr as seen from afar; W/m2 of a directional light"}),
            row(4, "inner_cone_angle", &T::inner_cone_angle, Cone, Radians, About{"half angle"}),
            row(5, "outer_cone_angle", &T::outer_cone_angle, Cone, Radians, About{"half angle"}),
            row(6, "radius", &T::radius, NotNegative, Metres, About{"of a sphere"}),
            row(7, "size", &T::size, NotNegative, Metres, About{"of a quad along x and y; it shines on one side"}),
            row(8, "angle", &T::angle, Range{0, std::numbers::pi / 2}, Radians, About{"of a directional light: half of what it spans in the sky"}));
    }
    // clang-format on
};

enum class Projection : std::uint8_t { Perspective, Orthographic };
constexpr auto enumerators(Projection) {
    return std::to_array<std::string_view>({"perspective", "orthographic"});
}
enum class Aperture : std::uint8_t { Uniform, Gaussian };  // how the light is spread over the lens
constexpr auto enumerators(Aperture) {
    return std::to_array<std::string_view>({"uniform", "gaussian"});
}

// In the frame of its parent transform: looks along -z, y up. A view takes its values; it is no node's
// business.
struct Camera {
    static constexpr KindRow Kind{ObjectKind::Camera, "camera", "cameras"};
    std::string name;
    double vertical_fov = 0.7;
    double aspect_ratio = 0.0;
    scene::Projection projection = scene::Projection::Perspective;
    double orthographic_height = 2.0;
    double lens_radius = 0.0;
    double focus_distance = 1.0;
    scene::Aperture aperture = scene::Aperture::Uniform;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Camera;
        constexpr Range Positive{0, MaxCoordinate, true};
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "vertical_fov", &T::vertical_fov, Range{0, std::numbers::pi, true}, Radians),
            row(3, "aspect_ratio", &T::aspect_ratio, NotNegative, About{"width / height; 0 = the picture's"}),
            row(4, "projection", &T::projection),
            row(5, "orthographic_height", &T::orthographic_height, Positive, Metres, About{"of what is seen"}),
            row(6, "lens_radius", &T::lens_radius, Range{0, MaxCoordinate}, Metres, About{"0 = a pinhole"}),
            row(7, "focus_distance", &T::focus_distance, Positive, Metres, About{"of the plane that is sharp, along the axis"}),
            row(8, "aperture", &T::aperture, About{"gaussian: sigma = half the lens' radius"}));
    }
    // clang-format on
};

// What camera rays see that hit nothing; all others see the environment.
enum class VisibleBackground : std::uint8_t { Environment, Color };
constexpr auto enumerators(VisibleBackground) {
    return std::to_array<std::string_view>({"environment", "color"});
}

// Light from infinitely far: color + strength x environment. Latitude-longitude map, row 0 is +y, column
// centre of the map is -z at rotation 0 (u grows to +x), turned about y.
struct Background {
    static constexpr KindRow Kind{ObjectKind::Background, "background", "backgrounds"};
    std::string name;
    glm::vec3 color{0.0f};
    ObjectId environment;
    float strength = 1.0f;
    float rotation = 0.0f;
    VisibleBackground visible = VisibleBackground::Environment;
    glm::vec4 visible_color{0.0f};
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Background;
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "color", &T::color, NotNegative, Radiance),
            row(3, "environment", &T::environment, Refers{bit(ObjectKind::Texture)}, About{"with rgb_float texels; 0 = none"}),
            row(4, "strength", &T::strength, NotNegative),
            row(5, "rotation", &T::rotation, Radians),
            row(6, "visible", &T::visible, About{"to camera rays that hit nothing"}),
            row(7, "visible_color", &T::visible_color, NotNegative, About{"alpha 0 = transparent"}));
    }
    // clang-format on
};

// Data that only some parts understand (Schwenk F54); all others carry it along.
struct Attachment {
    static constexpr KindRow Kind{ObjectKind::Attachment, "attachment", "attachments"};
    std::string name;
    std::string key, value;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Attachment;
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "key", &T::key, MaxName),
            row(3, "value", &T::value, Longest{1 << 20}));
    }
    // clang-format on
};

// The one object with a fixed id: where the graph starts and what rendering is relative to.
struct Root {
    static constexpr KindRow Kind{ObjectKind::Root, "root", "root"};
    std::string name;
    std::vector<ObjectId> children;
    ObjectId background;
    glm::dvec3 render_origin{0.0};
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Root;
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "children", &T::children, Refers{PlacedKinds}, DecodedChildren),
            row(3, "background", &T::background, Refers{bit(ObjectKind::Background)}),
            row(4, "render_origin", &T::render_origin, Range{-MaxCoordinate, MaxCoordinate}, Metres, About{"set by the master, on a coarse power-of-two grid"}));
    }
    // clang-format on
};

inline constexpr ObjectId RootId{1};
inline constexpr std::uint32_t RootLayers = 1;  // layer 0

using Object = std::variant<Root, Transform, Geometry, Material, Texture, Light, Camera, Background,
                            Attachment, SurfaceShader, Medium>;

// Every kind, in the order of Object.
template <class T>
struct KindRowsOf;
template <class... T>
struct KindRowsOf<std::variant<T...>> {
    static constexpr std::array rows{T::Kind...};
};
inline constexpr auto& Kinds = KindRowsOf<Object>::rows;

constexpr const KindRow& kind_row(ObjectKind kind) {
    for (const KindRow& row : Kinds) {
        if (row.kind == kind) return row;
    }
    return Kinds[0];  // not reached: every kind has a row
}
inline ObjectKind kind(const Object& object) {
    return Kinds[object.index()].kind;
}
constexpr const char* name(ObjectKind kind) {
    return kind_row(kind).name;
}
const std::string& name(const Object& object);

// The oneof of proto/scene.proto, for the codec.
template <class... T>
constexpr auto alternatives(const std::variant<Root, T...>*) {
    const auto row = []<class Kind>(const Kind*) {
        return Alternative<Kind>{static_cast<unsigned>(Kind::Kind.kind) + 1, Kind::Kind.name};
    };
    return std::tuple(row(static_cast<const Root*>(nullptr)), row(static_cast<const T*>(nullptr))...);
}

}  // namespace tessera::scene
