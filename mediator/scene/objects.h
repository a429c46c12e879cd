#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "mediator/base/ids.h"
#include "mediator/scene/blob.h"

// The minimal set of scene objects (Schwenk 5.3.2.1). Plain values; `fields()` lists the members in the order
// of `Field`, and everything that treats fields alike (masks, comparison, hashing) is derived from it.
// Metres, radians, linear Rec. 709; world right-handed, y up.
namespace tessera::scene {

// How often a geometry is going to move (Schwenk 5.4.1): static is built for tracing, animated for updating,
// unflagged starts as static and changes over at its first move.
enum class MotionHint : std::uint8_t { Unflagged, Static, Animated };

// The graph's inner node. Children may be transforms, geometries, lights, cameras and attachments; shared
// children are instances. No cycles. Layers (Schwenk F55) are for views to leave out: an object is in those
// of the nearest transform above it that names some, else in RootLayers.
struct Transform {
    enum class Field : std::uint8_t { Name, Matrix, Children, Hint, Layers };
    std::string name;
    glm::dmat4 matrix{1.0};  // parent from local, affine
    std::vector<ObjectId> children;
    MotionHint hint = MotionHint::Unflagged;
    std::uint32_t layers = 0;  // bit i: what hangs below is in layer i; 0 = as the parent says
    static constexpr auto fields() {
        return std::tuple(&Transform::name, &Transform::matrix, &Transform::children, &Transform::hint,
                          &Transform::layers);
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
        Colors
    };
    std::string name;
    ObjectId material;  // 0 = the default grey
    MotionHint hint = MotionHint::Unflagged;
    BlobRef indices;     // uint32 x 3 per triangle
    BlobRef positions;   // float x 3 per vertex
    BlobRef normals;     // float x 3 per vertex
    BlobRef tangents;    // float x 4 per vertex, w = handedness
    BlobRef tex_coords;  // float x 2 per vertex, v down as in glTF
    BlobRef colors;      // float x 4 per vertex, linear
    static constexpr auto fields() {
        return std::tuple(&Geometry::name, &Geometry::material, &Geometry::hint, &Geometry::indices,
                          &Geometry::positions, &Geometry::normals, &Geometry::tangents,
                          &Geometry::tex_coords, &Geometry::colors);
    }
};

// A texture as a material uses it: uv' = translate(offset) rotate(rotation) scale(scale) uv
// (KHR_texture_transform).
struct TextureSlot {
    ObjectId texture;  // 0 = none: the factor alone
    glm::vec2 offset{0.0f}, scale{1.0f};
    float rotation = 0.0f;
    friend bool operator==(const TextureSlot&, const TextureSlot&) = default;
};

enum class AlphaMode : std::uint8_t { Opaque, Mask, Blend };

// glTF 2.0 metallic-roughness: every value is factor x texture.
struct Material {
    enum class Field : std::uint8_t {
        Name,
        BaseColor,
        BaseColorTexture,
        Metallic,
        Roughness,
        MetallicRoughnessTexture,
        NormalTexture,
        NormalScale,
        Emission,
        EmissionTexture,
        AlphaMode,
        AlphaCutoff,
        DoubleSided,
        Unlit,
        IndexOfRefraction,
        Transmission
    };
    std::string name;
    glm::vec4 base_color{0.8f, 0.8f, 0.8f, 1.0f};
    TextureSlot base_color_texture;  // sRGB
    float metallic = 0.0f;
    float roughness = 1.0f;                  // perceptual; alpha = roughness^2
    TextureSlot metallic_roughness_texture;  // g = roughness, b = metallic
    TextureSlot normal_texture;              // tangent space, rgb = (n + 1) / 2
    float normal_scale = 1.0f;
    glm::vec3 emission{0.0f};      // radiance, strength included
    TextureSlot emission_texture;  // sRGB
    AlphaMode alpha_mode = AlphaMode::Opaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    bool unlit = false;
    float index_of_refraction = 1.5f;
    float transmission = 0.0f;
    static constexpr auto fields() {
        return std::tuple(&Material::name, &Material::base_color, &Material::base_color_texture,
                          &Material::metallic, &Material::roughness, &Material::metallic_roughness_texture,
                          &Material::normal_texture, &Material::normal_scale, &Material::emission,
                          &Material::emission_texture, &Material::alpha_mode, &Material::alpha_cutoff,
                          &Material::double_sided, &Material::unlit, &Material::index_of_refraction,
                          &Material::transmission);
    }
};

enum class TexelFormat : std::uint8_t { Rgba8, Rgba8Srgb, RgbFloat };
enum class Wrap : std::uint8_t { Repeat, Mirror, Clamp };
enum class TextureFilter : std::uint8_t { Linear, Nearest };

// Decoded texels, rows from the top; decoding is the client's work, a node never parses image files.
struct Texture {
    enum class Field : std::uint8_t { Name, Width, Height, Format, WrapS, WrapT, Filter, Texels };
    std::string name;
    std::uint32_t width = 0, height = 0;
    TexelFormat format = TexelFormat::Rgba8;
    Wrap wrap_s = Wrap::Repeat, wrap_t = Wrap::Repeat;
    TextureFilter filter = TextureFilter::Linear;
    BlobRef texels;
    static constexpr auto fields() {
        return std::tuple(&Texture::name, &Texture::width, &Texture::height, &Texture::format,
                          &Texture::wrap_s, &Texture::wrap_t, &Texture::filter, &Texture::texels);
    }
};

enum class LightKind : std::uint8_t { Point, Spot, Directional };

// KHR_lights_punctual, in the frame of its parent transform: shines along -z. Lights with an extent are
// emissive geometry. Intensity: W/sr (point, spot), W/m2 (directional).
struct Light {
    enum class Field : std::uint8_t { Name, Kind, Intensity, InnerConeAngle, OuterConeAngle };
    std::string name;
    LightKind kind = LightKind::Point;
    glm::vec3 intensity{1.0f};
    float inner_cone_angle = 0.0f;             // half angles
    float outer_cone_angle = 0.785398163397f;  // pi / 4
    static constexpr auto fields() {
        return std::tuple(&Light::name, &Light::kind, &Light::intensity, &Light::inner_cone_angle,
                          &Light::outer_cone_angle);
    }
};

// Pinhole, in the frame of its parent transform: looks along -z, y up. A view takes its values; it is no
// node's business.
struct Camera {
    enum class Field : std::uint8_t { Name, VerticalFov, AspectRatio };
    std::string name;
    double vertical_fov = 0.7;
    double aspect_ratio = 0.0;  // width / height; 0 = the picture's
    static constexpr auto fields() {
        return std::tuple(&Camera::name, &Camera::vertical_fov, &Camera::aspect_ratio);
    }
};

// Light from infinitely far: color + strength x environment. Latitude-longitude map, row 0 is +y, column
// centre of the map is -z at rotation 0 (u grows to +x), turned about y.
struct Background {
    enum class Field : std::uint8_t { Name, Color, Environment, Strength, Rotation };
    std::string name;
    glm::vec3 color{0.0f};
    ObjectId environment;  // a Texture with RgbFloat texels, 0 = none
    float strength = 1.0f;
    float rotation = 0.0f;
    static constexpr auto fields() {
        return std::tuple(&Background::name, &Background::color, &Background::environment,
                          &Background::strength, &Background::rotation);
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
};

inline constexpr ObjectId RootId{1};
inline constexpr std::uint32_t RootLayers = 1;  // layer 0

using Object =
    std::variant<Root, Transform, Geometry, Material, Texture, Light, Camera, Background, Attachment>;
enum class ObjectKind : std::uint8_t {
    Root,
    Transform,
    Geometry,
    Material,
    Texture,
    Light,
    Camera,
    Background,
    Attachment
};
inline ObjectKind kind(const Object& object) {
    return static_cast<ObjectKind>(object.index());
}
const char* name(ObjectKind kind);
const std::string& name(const Object& object);

}  // namespace tessera::scene
