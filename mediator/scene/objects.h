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

#include "mediator/base/description.h"
#include "mediator/base/ids.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/materials.h"

// The minimal set of scene objects (Schwenk 5.3.2.1). Plain values; `fields()` lists the members in the order
// of `Field`, and everything that treats fields alike (masks, comparison, hashing) is derived from it.
// Metres, radians, linear Rec. 709; world right-handed, y up.
namespace tessera::scene {

// Fields of an object of any kind: bit i is the i-th.
using FieldMask = std::uint64_t;
inline constexpr std::size_t MaxFields = 64;

// The mask of one field.
constexpr FieldMask field_bit(unsigned field) {
    return FieldMask{1} << field;
}

// How often a geometry is going to move (Schwenk 5.4.1): static is built for tracing, animated for updating,
// unflagged starts as static and changes over at its first move.
enum class MotionHint : std::uint8_t { Unflagged, Static, Animated };
constexpr auto enumerators(MotionHint) {
    return std::to_array<std::string_view>({"unflagged", "static", "animated"});
}

// Steps of motion that an object may have after its first.
inline constexpr std::size_t MaxMotion = 15;
// Beyond these a list is not decoded; validation takes far less motion and says so better.
inline constexpr std::size_t MaxDecodedMotion = 256, MaxChildren = 16'000'000;

// The graph's inner node. Children may be transforms, geometries, lights, cameras and attachments; shared
// children are instances. No cycles. Layers (Schwenk F55) are for views to leave out: an object is in those
// of the nearest transform above it that names some, else in RootLayers.
struct Transform {
    enum class Field : std::uint8_t { Name, Matrix, Children, Hint, Layers, Motion };
    std::string name;
    glm::dmat4 matrix{1.0};  // parent from local, affine
    std::vector<ObjectId> children;
    MotionHint hint = MotionHint::Unflagged;
    std::uint32_t layers = 0;  // bit i: what hangs below is in layer i; 0 = as the parent says
    // While the shutter is open: matrices at even steps of time after `matrix`, the last when it closes;
    // between them each element goes in a straight line. Empty: it stands still. At most MaxMotion.
    std::vector<glm::dmat4> motion;
    static constexpr auto fields() {
        return std::tuple(&Transform::name, &Transform::matrix, &Transform::children, &Transform::hint,
                          &Transform::layers, &Transform::motion);
    }
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &Transform::name), row(2, "matrix", &Transform::matrix),
                          row(3, "children", &Transform::children, Limit{MaxChildren}),
                          row(4, "hint", &Transform::hint), row(5, "layers", &Transform::layers),
                          row(6, "motion", &Transform::motion, Limit{MaxDecodedMotion}));
    }
};

// Indexed triangles. Arrays are blobs of little-endian 32-bit elements; empty = not there.
struct Geometry {
    enum class Field : std::uint8_t {
        Name,
        Material,
        Hint,
        Indices,
        Positions,
        Normals,
        Tangents,
        TexCoords,
        Colors,
        TexCoords1,
        Medium,
        MotionPositions,
        MotionNormals
    };
    std::string name;
    ObjectId material;  // a Material or a SurfaceShader; 0 = the default grey
    MotionHint hint = MotionHint::Unflagged;
    BlobRef indices;       // uint32 x 3 per triangle
    BlobRef positions;     // float x 3 per vertex
    BlobRef normals;       // float x 3 per vertex
    BlobRef tangents;      // float x 4 per vertex, w = handedness
    BlobRef tex_coords;    // float x 2 per vertex, v down as in glTF
    BlobRef colors;        // float x 4 per vertex, linear
    BlobRef tex_coords_1;  // as tex_coords
    ObjectId medium;       // what its body is filled with; 0 = nothing
    // As a transform's motion: where the vertices are at even steps of time after `positions`, and their
    // normals (none, or as many: then those of the beginning stay).
    std::vector<BlobRef> motion_positions, motion_normals;
    static constexpr auto fields() {
        return std::tuple(&Geometry::name, &Geometry::material, &Geometry::hint, &Geometry::indices,
                          &Geometry::positions, &Geometry::normals, &Geometry::tangents,
                          &Geometry::tex_coords, &Geometry::colors, &Geometry::tex_coords_1,
                          &Geometry::medium, &Geometry::motion_positions, &Geometry::motion_normals);
    }
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &Geometry::name), row(2, "material", &Geometry::material),
                          row(3, "hint", &Geometry::hint), row(4, "indices", &Geometry::indices),
                          row(5, "positions", &Geometry::positions), row(6, "normals", &Geometry::normals),
                          row(7, "tangents", &Geometry::tangents),
                          row(8, "tex_coords", &Geometry::tex_coords), row(9, "colors", &Geometry::colors),
                          row(10, "tex_coords_1", &Geometry::tex_coords_1),
                          row(11, "medium", &Geometry::medium),
                          row(12, "motion_positions", &Geometry::motion_positions, Limit{MaxDecodedMotion}),
                          row(13, "motion_normals", &Geometry::motion_normals, Limit{MaxDecodedMotion}));
    }
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

// Decoded texels, rows from the top, slices of a volume one after the other (only media read more than the
// first); decoding is the client's work, a node never parses image files.
struct Texture {
    enum class Field : std::uint8_t { Name, Width, Height, Format, WrapS, WrapT, Filter, Texels, Depth };
    std::string name;
    std::uint32_t width = 0, height = 0;
    TexelFormat format = TexelFormat::Rgba8;
    Wrap wrap_s = Wrap::Repeat, wrap_t = Wrap::Repeat;
    TextureFilter filter = TextureFilter::Linear;
    BlobRef texels;
    std::uint32_t depth = 1;  // slices
    static constexpr auto fields() {
        return std::tuple(&Texture::name, &Texture::width, &Texture::height, &Texture::format,
                          &Texture::wrap_s, &Texture::wrap_t, &Texture::filter, &Texture::texels,
                          &Texture::depth);
    }
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &Texture::name), row(2, "width", &Texture::width),
                          row(3, "height", &Texture::height), row(4, "format", &Texture::format),
                          row(5, "wrap_s", &Texture::wrap_s), row(6, "wrap_t", &Texture::wrap_t),
                          row(7, "filter", &Texture::filter), row(8, "texels", &Texture::texels),
                          row(9, "depth", &Texture::depth));
    }
};

enum class LightKind : std::uint8_t { Point, Spot, Directional, Sphere, Quad };
constexpr auto enumerators(LightKind) {
    return std::to_array<std::string_view>({"point", "spot", "directional", "sphere", "quad"});
}

// KHR_lights_punctual, in the frame of its parent transform: shines along -z; only its place and direction
// count, not its scale. Intensity: W/sr as seen from afar (point, spot, sphere, quad), W/m2 (directional).
// Spheres and quads can be seen and do not block light; emissive geometry is a light, too.
struct Light {
    enum class Field : std::uint8_t {
        Name,
        Kind,
        Intensity,
        InnerConeAngle,
        OuterConeAngle,
        Radius,
        Size,
        Angle
    };
    std::string name;
    LightKind kind = LightKind::Point;
    glm::vec3 intensity{1.0f};
    float inner_cone_angle = 0.0f;             // half angles
    float outer_cone_angle = 0.785398163397f;  // pi / 4
    float radius = 0.1f;                       // of a sphere, m
    glm::vec2 size{1.0f};                      // of a quad along x and y, m; it shines on one side
    float angle = 0.0f;                        // of a directional light: half of what it spans in the sky
    static constexpr auto fields() {
        return std::tuple(&Light::name, &Light::kind, &Light::intensity, &Light::inner_cone_angle,
                          &Light::outer_cone_angle, &Light::radius, &Light::size, &Light::angle);
    }
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "name", &Light::name), row(2, "kind", &Light::kind),
            row(3, "intensity", &Light::intensity), row(4, "inner_cone_angle", &Light::inner_cone_angle),
            row(5, "outer_cone_angle", &Light::outer_cone_angle), row(6, "radius", &Light::radius),
            row(7, "size", &Light::size), row(8, "angle", &Light::angle));
    }
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
    enum class Field : std::uint8_t {
        Name,
        VerticalFov,
        AspectRatio,
        Projection,
        OrthographicHeight,
        LensRadius,
        FocusDistance,
        Aperture
    };
    std::string name;
    double vertical_fov = 0.7;
    double aspect_ratio = 0.0;  // width / height; 0 = the picture's
    scene::Projection projection = scene::Projection::Perspective;
    double orthographic_height = 2.0;                     // of what is seen, m
    double lens_radius = 0.0;                             // m; 0 = a pinhole
    double focus_distance = 1.0;                          // of the plane that is sharp, along the axis, m
    scene::Aperture aperture = scene::Aperture::Uniform;  // Gaussian: sigma = half the lens' radius
    static constexpr auto fields() {
        return std::tuple(&Camera::name, &Camera::vertical_fov, &Camera::aspect_ratio, &Camera::projection,
                          &Camera::orthographic_height, &Camera::lens_radius, &Camera::focus_distance,
                          &Camera::aperture);
    }
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "name", &Camera::name), row(2, "vertical_fov", &Camera::vertical_fov),
            row(3, "aspect_ratio", &Camera::aspect_ratio), row(4, "projection", &Camera::projection),
            row(5, "orthographic_height", &Camera::orthographic_height),
            row(6, "lens_radius", &Camera::lens_radius), row(7, "focus_distance", &Camera::focus_distance),
            row(8, "aperture", &Camera::aperture));
    }
};

// What camera rays see that hit nothing; all others see the environment.
enum class VisibleBackground : std::uint8_t { Environment, Color };
constexpr auto enumerators(VisibleBackground) {
    return std::to_array<std::string_view>({"environment", "color"});
}

// Light from infinitely far: color + strength x environment. Latitude-longitude map, row 0 is +y, column
// centre of the map is -z at rotation 0 (u grows to +x), turned about y.
struct Background {
    enum class Field : std::uint8_t { Name, Color, Environment, Strength, Rotation, Visible, VisibleColor };
    std::string name;
    glm::vec3 color{0.0f};
    ObjectId environment;  // a Texture with RgbFloat texels, 0 = none
    float strength = 1.0f;
    float rotation = 0.0f;
    VisibleBackground visible = VisibleBackground::Environment;
    glm::vec4 visible_color{0.0f};  // with alpha, 0 = transparent
    static constexpr auto fields() {
        return std::tuple(&Background::name, &Background::color, &Background::environment,
                          &Background::strength, &Background::rotation, &Background::visible,
                          &Background::visible_color);
    }
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &Background::name), row(2, "color", &Background::color),
                          row(3, "environment", &Background::environment),
                          row(4, "strength", &Background::strength),
                          row(5, "rotation", &Background::rotation), row(6, "visible", &Background::visible),
                          row(7, "visible_color", &Background::visible_color));
    }
};

// Data that only some parts understand (Schwenk F54); everybody else carries it along.
struct Attachment {
    enum class Field : std::uint8_t { Name, Key, Value };
    std::string name;
    std::string key, value;
    static constexpr auto fields() {
        return std::tuple(&Attachment::name, &Attachment::key, &Attachment::value);
    }
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &Attachment::name), row(2, "key", &Attachment::key),
                          row(3, "value", &Attachment::value));
    }
};

// The one object with a fixed id: where the graph starts and what rendering is relative to.
struct Root {
    enum class Field : std::uint8_t { Name, Children, Background, RenderOrigin };
    std::string name;
    std::vector<ObjectId> children;
    ObjectId background;
    glm::dvec3 render_origin{0.0};  // set by the authority, on a coarse power-of-two grid
    static constexpr auto fields() {
        return std::tuple(&Root::name, &Root::children, &Root::background, &Root::render_origin);
    }
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "name", &Root::name), row(2, "children", &Root::children, Limit{MaxChildren}),
            row(3, "background", &Root::background), row(4, "render_origin", &Root::render_origin));
    }
};

inline constexpr ObjectId RootId{1};
inline constexpr std::uint32_t RootLayers = 1;  // layer 0

using Object = std::variant<Root, Transform, Geometry, Material, Texture, Light, Camera, Background,
                            Attachment, SurfaceShader, Medium>;
// Numbers of the oneof in proto/scene.proto.
constexpr auto alternatives(const Object*) {
    return std::tuple(Alternative<Root>{1, "root"}, Alternative<Transform>{2, "transform"},
                      Alternative<Geometry>{3, "geometry"}, Alternative<Material>{4, "material"},
                      Alternative<Texture>{5, "texture"}, Alternative<Light>{6, "light"},
                      Alternative<Camera>{7, "camera"}, Alternative<Background>{8, "background"},
                      Alternative<Attachment>{9, "attachment"},
                      Alternative<SurfaceShader>{10, "surface_shader"}, Alternative<Medium>{11, "medium"});
}
enum class ObjectKind : std::uint8_t {
    Root,
    Transform,
    Geometry,
    Material,
    Texture,
    Light,
    Camera,
    Background,
    Attachment,
    SurfaceShader,
    Medium
};
inline ObjectKind kind(const Object& object) {
    return static_cast<ObjectKind>(object.index());
}
const char* name(ObjectKind kind);
const std::string& name(const Object& object);

}  // namespace tessera::scene
