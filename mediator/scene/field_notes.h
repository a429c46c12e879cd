#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string_view>

#include "mediator/base/description.h"

// Annotations of the rows of scene objects (mediator/base/description.h): the single source for validation, the edit
// language and its help, the Python classes and the import of extras.
namespace tessera::scene {

// A set of fields of an object: the bit of a row is its number - 1.
using FieldMask = std::uint64_t;
inline constexpr std::size_t MaxFields = 64;

// The mask of the field with this index, its number - 1.
constexpr FieldMask field_bit(unsigned field) {
    return FieldMask{1} << field;
}

// The numbers are part of state hashes; on the wire they are the field numbers of the oneof in proto/scene.proto
// minus 1.
enum class ObjectKind : std::uint8_t {
    Root = 0,
    Transform = 1,
    Geometry = 2,
    Material = 3,
    Texture = 4,
    Light = 5,
    Camera = 6,
    Background = 7,
    Attachment = 8,
    SurfaceShader = 9,
    Medium = 10
};

constexpr std::uint32_t bit(ObjectKind kind) {
    return 1u << static_cast<unsigned>(kind);
}

// One kind of objects: `name` as in proto/scene.proto, `plural` as in paths.
struct KindRow {
    ObjectKind kind;
    const char *name, *plural;
};

// Kinds that may be children of the root or of a transform.
inline constexpr std::uint32_t PlacedKinds = bit(ObjectKind::Transform) | bit(ObjectKind::Geometry) |
                                             bit(ObjectKind::Light) | bit(ObjectKind::Camera) |
                                             bit(ObjectKind::Attachment);

// The range of a number, or of each component of a vector. Numbers without a range have to be finite.
struct Range {
    double minimum = 0.0, maximum = 0.0;
    bool exclusive = false;
};
inline constexpr double Unbounded = std::numeric_limits<float>::max();
inline constexpr double MaxCoordinate = 1e15;  // metres; beyond, double transforms lose the centimetre
inline constexpr Range Fraction{0.0, 1.0}, NotNegative{0.0, Unbounded};
inline constexpr Range Cone{0.0, std::numbers::pi / 2 + 1e-6};

// The unit of a number; none = dimensionless.
struct Unit {
    std::string_view symbol;
};
inline constexpr Unit Metres{"m"}, Radians{"rad"}, Radiance{"W/(m2 sr)"};

// The maximum bytes of a text, or entries of a list.
struct MaxSize {
    std::size_t size;
};
inline constexpr MaxSize MaxName{4096};

// The kinds that a reference may point to, a bit(kind) each. Texture slots do not need it.
struct Refers {
    std::uint32_t kinds;
};

// The elements of a blob, little-endian, with this number of components.
enum class Element : std::uint8_t { Uint32, Float32, Byte };
struct Array {
    Element element;
    unsigned components;
    bool is_per_vertex = false;  // one element per position

    constexpr std::size_t bytes() const { return components * (element == Element::Byte ? 1 : 4); }
};

// A texture slot for data; all others are for colours.
struct DataTexels {};

// glTF lacks this field: it is stored in extras (client/import/gltf_extras.h).
struct GltfExtras {};

// Further help text, also in the Python classes.
struct Help {
    std::string_view text;
};

// The note of this type, or `otherwise`.
template <class Note, class Row>
constexpr Note note_or(const Row& row, const Note& otherwise) {
    if constexpr (Row::template has<Note>) {
        return row.template note<Note>();
    } else {
        return otherwise;
    }
}

}  // namespace tessera::scene
