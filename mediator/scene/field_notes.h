#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string_view>

#include "mediator/base/description.h"

// What the rows of scene objects say beside number, name and member (mediator/base/description.h). Validation,
// the edit language, its help, the Python classes and the importers of extras read it here and nowhere else.
namespace tessera::scene {

// Fields of an object of any kind: the bit of a row is its number - 1.
using FieldMask = std::uint64_t;
inline constexpr std::size_t MaxFields = 64;

// The mask of the field with this index, its number - 1.
constexpr FieldMask field_bit(unsigned field) {
    return FieldMask{1} << field;
}

// Its numbers are written into state hashes; on the wire they are those of the oneof in proto/scene.proto
// less 1.
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

// What may be a child of the root or of a transform.
inline constexpr std::uint32_t PlacedKinds = bit(ObjectKind::Transform) | bit(ObjectKind::Geometry) |
                                             bit(ObjectKind::Light) | bit(ObjectKind::Camera) |
                                             bit(ObjectKind::Attachment);

// Of a number, or of each component of a vector. Numbers without a range only have to be finite.
struct Range {
    double least = 0.0, most = 0.0;
    bool excludes_ends = false;
};
inline constexpr double Unbounded = std::numeric_limits<float>::max();
inline constexpr double MaxCoordinate = 1e15;  // metres; beyond, double transforms lose the centimetre
inline constexpr Range Fraction{0.0, 1.0}, NotNegative{0.0, Unbounded};
inline constexpr Range Cone{0.0, std::numbers::pi / 2 + 1e-6};

// Of a number; none = a factor.
struct Unit {
    std::string_view symbol;
};
inline constexpr Unit Metres{"m"}, Radians{"rad"}, Radiance{"W/(m2 sr)"};

// The most bytes of a text, or the most entries of a list.
struct Longest {
    std::size_t size;
};
inline constexpr Longest MaxName{4096};

// The kinds that a reference may name, bit(kind) each. References to textures within slots need none.
struct Refers {
    std::uint32_t kinds;
};

// What a blob holds: little-endian elements of so many components.
enum class Element : std::uint8_t { Uint32, Float32, Byte };
struct Array {
    Element element;
    unsigned components;
    bool is_per_vertex = false;  // as many elements as there are positions

    constexpr std::size_t bytes() const { return components * (element == Element::Byte ? 1 : 4); }
};

// A texture slot whose texels are numbers; the others hold colours.
struct DataTexels {};

// glTF has no place for the field: it is written into extras, from which every field can be read.
struct BesideGltf {};

// What else a reader of help, or of the Python classes, has to know.
struct About {
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
