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

// The minimal set of scene objects (Schwenk 5.3.2.1). Plain values; `describe` has one row for each field, from which
// masks, validation, comparison, hashing, the wire format, the edit language and the Python classes are derived.
// Metres, radians, linear Rec. 709; world right-handed, y up.
namespace tessera::scene {

// How often a geometry will move (Schwenk 5.4.1): the BVH of a static one is built for tracing speed, that of an
// animated one for updates; unflagged starts as static and changes at its first move.
enum class MotionHint : std::uint8_t { Unflagged, Static, Animated };
constexpr auto enumerators(MotionHint) {
    return std::to_array<std::string_view>({"unflagged", "static", "animated"});
}

// The maximum number of motion keys after the first.
inline constexpr std::size_t MaxMotion = 15;
// Decoder limits. Validation allows fewer motion keys, with a better message.
inline constexpr std::size_t MaxDecodedMotion = 256, MaxChildren = 16'000'000;
inline constexpr Limit DecodedMotion{MaxDecodedMotion}, DecodedChildren{MaxChildren};

// An inner node of the scene graph. Children are transforms, geometries, lights, cameras and attachments; shared
// children are instances. No cycles. Views can exclude layers of objects (Schwenk F55): an object is in the layers of
// the nearest transform above it that sets some, else in RootLayers.
struct Transform {
    static constexpr KindRow Kind{ObjectKind::Transform, "transform", "transforms"};
    std::string name;
    glm::dmat4 matrix{1.0};
    std::vector<ObjectId> children;
    MotionHint hint = MotionHint::Unflagged;
    std::uint32_t layers = 0;
    // Motion keys while the shutter is open: matrices at even times after `matrix`, the last one when it closes;
    // elements are interpolated linearly. Empty: no motion.
    std::vector<glm::dmat4> motion;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Transform;
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "matrix", &T::matrix, Help{"parent from local, affine"}),
            row(3, "children", &T::children, Refers{PlacedKinds}, DecodedChildren),
            row(4, "hint", &T::hint),
            row(5, "layers", &T::layers, Help{"bit i: the subtree is in layer i; 0 = inherited"}),
            row(6, "motion", &T::motion, MaxSize{MaxMotion}, DecodedMotion, Help{"motion keys at even times after matrix"}));
    }
    // clang-format on
};

// Indexed triangles. Arrays are blobs; empty = absent.
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
            row(2, "material", &T::material, Refers{bit(ObjectKind::Material) | bit(ObjectKind::SurfaceShader)}, Help{"0 = the default grey"}),
            row(3, "hint", &T::hint),
            row(4, "indices", &T::indices, Array{Element::Uint32, 3}, Help{"of a triangle"}),
            row(5, "positions", &T::positions, of_vertex(3)),
            row(6, "normals", &T::normals, of_vertex(3)),
            row(7, "tangents", &T::tangents, of_vertex(4), Help{"w = handedness"}),
            row(8, "tex_coords", &T::tex_coords, of_vertex(2), Help{"v down as in glTF"}),
            row(9, "colors", &T::colors, of_vertex(4), Help{"linear"}),
            row(10, "tex_coords_1", &T::tex_coords_1, of_vertex(2)),
            row(11, "medium", &T::medium, Refers{bit(ObjectKind::Medium)}, Help{"interior medium; 0 = none"}),
            row(12, "motion_positions", &T::motion_positions, of_vertex(3), MaxSize{MaxMotion}, DecodedMotion, Help{"motion keys at even times after positions"}),
            row(13, "motion_normals", &T::motion_normals, of_vertex(3), MaxSize{MaxMotion}, DecodedMotion, Help{"empty, or as many as motion_positions"}));
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

// Decoded texels. Clients decode image files; nodes never do.
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
            row(8, "texels", &T::texels, Array{Element::Byte, 1}, Help{"rows from the top, slices one after the other"}),
            row(9, "depth", &T::depth, Edge, Help{"slices; only media read more than the first"}));
    }
    // clang-format on
};

enum class LightKind : std::uint8_t { Point, Spot, Directional, Sphere, Quad };
constexpr auto enumerators(LightKind) {
    return std::to_array<std::string_view>({"point", "spot", "directional", "sphere", "quad"});
}

// As KHR_lights_punctual, in the frame of its parent transform: emits along -z; only position and direction of the
// transform count, not its scale. Spheres and quads are visible and do not block light. Emissive geometry is a light
// as well.
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
            row(3, "intensity", &T::intensity, NotNegative, Help{"W/sr in the far field; W/m2 for directional lights"}),
            row(4, "inner_cone_angle", &T::inner_cone_angle, Cone, Radians, Help{"half angle"}),
            row(5, "outer_cone_angle", &T::outer_cone_angle, Cone, Radians, Help{"half angle"}),
            row(6, "radius", &T::radius, NotNegative, Metres, Help{"of a sphere"}),
            row(7, "size", &T::size, NotNegative, Metres, Help{"of a quad along x and y; it emits on one side"}),
            row(8, "angle", &T::angle, Range{0, std::numbers::pi / 2}, Radians, Help{"of a directional light: half its angular diameter"}));
    }
    // clang-format on
};

enum class Projection : std::uint8_t { Perspective, Orthographic };
constexpr auto enumerators(Projection) {
    return std::to_array<std::string_view>({"perspective", "orthographic"});
}
enum class Aperture : std::uint8_t { Uniform, Gaussian };  // distribution of samples over the lens
constexpr auto enumerators(Aperture) {
    return std::to_array<std::string_view>({"uniform", "gaussian"});
}

// In the frame of its parent transform: looks along -z, y up. Views copy its values; render nodes ignore it.
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
            row(3, "aspect_ratio", &T::aspect_ratio, NotNegative, Help{"width / height; 0 = the picture's"}),
            row(4, "projection", &T::projection),
            row(5, "orthographic_height", &T::orthographic_height, Positive, Metres, Help{"of the view"}),
            row(6, "lens_radius", &T::lens_radius, Range{0, MaxCoordinate}, Metres, Help{"0 = a pinhole"}),
            row(7, "focus_distance", &T::focus_distance, Positive, Metres, Help{"of the focal plane, along the axis"}),
            row(8, "aperture", &T::aperture, Help{"gaussian: sigma = half the lens' radius"}));
    }
    // clang-format on
};

// The background for camera rays that hit nothing; all other rays see the environment.
enum class VisibleBackground : std::uint8_t { Environment, Color };
constexpr auto enumerators(VisibleBackground) {
    return std::to_array<std::string_view>({"environment", "color"});
}

// Where the middle column of an environment map lies: u grows towards +x or +z. The first is that of files of older versions;
// the other is that of glTF viewers, three.js and Blender.
enum class MapCenter : std::uint8_t { NegativeZ, PositiveX };
constexpr auto enumerators(MapCenter) {
    return std::to_array<std::string_view>({"negative_z", "positive_x"});
}

// Infinite light: color + strength x environment. Latitude-longitude map; row 0 is +y.
struct Background {
    static constexpr KindRow Kind{ObjectKind::Background, "background", "backgrounds"};
    std::string name;
    glm::vec3 color{0.0f};
    ObjectId environment;
    float strength = 1.0f;
    float rotation = 0.0f;
    VisibleBackground visible = VisibleBackground::Environment;
    glm::vec4 visible_color{0.0f};
    MapCenter map_center = MapCenter::PositiveX;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Background;
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "color", &T::color, NotNegative, Radiance),
            row(3, "environment", &T::environment, Refers{bit(ObjectKind::Texture)}, Help{"with rgb_float texels; 0 = none"}),
            row(4, "strength", &T::strength, NotNegative),
            row(5, "rotation", &T::rotation, Radians, Help{"of the environment map, counter-clockwise as seen from above"}),
            row(6, "visible", &T::visible, Help{"to camera rays that hit nothing"}),
            row(7, "visible_color", &T::visible_color, NotNegative, Help{"alpha 0 = transparent"}),
            row(8, "map_center", &T::map_center, ZeroWhenAbsent{}, Help{"the direction of the middle of the environment map, without rotation"}));
    }
    // clang-format on
};

// Application data (Schwenk F54), which Tessera stores and distributes unchanged.
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
            row(3, "value", &T::value, MaxSize{1 << 20}));
    }
    // clang-format on
};

// The only object with a fixed id: the root of the graph, with the render origin.
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
            row(4, "render_origin", &T::render_origin, Range{-MaxCoordinate, MaxCoordinate}, Metres, Help{"set by the master, on a coarse power-of-two grid"}));
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
