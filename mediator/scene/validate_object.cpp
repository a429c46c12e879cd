#include "mediator/scene/validate_object.h"

#include <cstdio>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "mediator/scene/fields.h"

namespace tessera::scene {

namespace {

constexpr std::uint64_t MaxElements = std::uint64_t{1} << 31;
constexpr Range Finite{-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};

std::string text_of(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

bool is_inside(double value, const Range& range) {
    if (range.exclusive) return value > range.minimum && value < range.maximum;
    return value >= range.minimum && value <= range.maximum;
}

// A field, one within a texture slot, or an entry of a list. Formatted only for problems.
struct FieldPath {
    std::string_view field, part = {};
    std::size_t entry = 0;
    bool has_entry = false;

    std::string text() const {
        std::string text(field);
        if (!part.empty()) text += "." + std::string(part);
        if (has_entry) text += "[" + std::to_string(entry) + "]";
        return text;
    }
};

template <class E>
std::string choices() {
    std::string text;
    for (const std::string_view name : enumerators(E{}))
        text += (text.empty() ? "" : ", ") + std::string(name);
    return text;
}

// Collects what is wrong with one object.
class Check {
  public:
    void add(std::string cause) { causes_.push_back(std::move(cause)); }

    template <class T>
    void fields(const T& object) {
        for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
            value(row_of<T, I>, row_of<T, I>.of(object), {row_of<T, I>.name});
        });
    }
    std::vector<std::string> take() { return std::move(causes_); }

  private:
    template <class Row, class V>
    void value(const Row& row, const V& value, const FieldPath& path) {
        if constexpr (std::is_same_v<V, bool> || std::is_same_v<V, ObjectId>) {
            return;
        } else if constexpr (std::is_arithmetic_v<V>) {
            number(static_cast<double>(value), note_or(row, Finite), path);
        } else if constexpr (std::is_enum_v<V>) {
            if (enumerator_name(value).empty())
                add(path.text() + " is " + std::to_string(static_cast<int>(value)) +
                    ": it has to be one of " + choices<V>());
        } else if constexpr (std::is_same_v<V, std::string>) {
            size(value.size(), row.template note<MaxSize>(), path, " bytes");
        } else if constexpr (std::is_same_v<V, TextureSlot>) {
            for_each_row<V>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
                this->value(row_of<V, I>, row_of<V, I>.of(value), {path.field, row_of<V, I>.name});
            });
        } else if constexpr (std::is_same_v<V, glm::dmat4>) {
            matrix(value, path);
        } else if constexpr (std::is_same_v<V, BlobRef>) {
            const std::size_t element = row.template note<Array>().bytes();
            if (value.byte_size % element != 0)
                add(path.text() + " has " + std::to_string(value.byte_size) + " bytes: an element has " +
                    std::to_string(element));
        } else if constexpr (requires { value.length(); }) {
            for (glm::length_t i = 0; i < V::length(); ++i) number(value[i], note_or(row, Finite), path);
        } else {
            list(row, value, path);
        }
    }
    template <class Row, class V>
    void list(const Row& row, const V& values, const FieldPath& path) {
        if constexpr (Row::template has<MaxSize>)
            size(values.size(), row.template note<MaxSize>(), path, " entries");
        if constexpr (!std::is_same_v<typename V::value_type, ObjectId>) {
            for (std::size_t i = 0; i < values.size(); ++i) value(row, values[i], {path.field, {}, i, true});
        }
    }
    void number(double value, const Range& range, const FieldPath& path) {
        if (!is_inside(value, range))
            add(path.text() + " is " + text_of(value) + ": it has to be " + scene::text_of(range));
    }
    void size(std::size_t size, const MaxSize& longest, const FieldPath& path, const char* what) {
        if (size > longest.size)
            add(path.text() + " has " + std::to_string(size) + what + ": there may be " +
                std::to_string(longest.size));
    }
    void matrix(const glm::dmat4& m, const FieldPath& path) {
        for (glm::length_t i = 0; i < 16; ++i) number(m[i / 4][i % 4], Finite, path);
        if (m[0][3] != 0.0 || m[1][3] != 0.0 || m[2][3] != 0.0 || m[3][3] != 1.0)
            add(path.text() + " is not affine: its last row has to be 0 0 0 1");
        if (glm::any(glm::greaterThan(glm::abs(glm::dvec3(m[3])), glm::dvec3(MaxCoordinate))))
            add("the translation of " + path.text() + " is longer than 1e15 m: move the scene");
    }

    std::vector<std::string> causes_;
};

// Checks across fields. Sizes of arrays have to match; their contents are checked by validate_blobs.
void check_together(const Geometry& geometry, Check& check) {
    if (geometry.positions.empty() || geometry.indices.empty())
        check.add("it has no positions or no indices: a mesh needs both");
    const std::uint64_t vertices = geometry.positions.byte_size / 12;
    if (vertices > MaxElements || geometry.indices.byte_size / 12 > MaxElements)
        check.add("it has more than 2^31 vertices or triangles: split it");
    const auto per_vertex = [&](std::uint64_t size, std::size_t element, const FieldPath& path) {
        if (size != vertices * element)
            check.add(path.text() + " has " + std::to_string(size) + " bytes: " + std::to_string(vertices) +
                      " vertices need " + std::to_string(vertices * element));
    };
    for_each_row<Geometry>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        constexpr auto& row = row_of<Geometry, I>;
        constexpr Array array = note_or(row, Array{});
        if constexpr (array.is_per_vertex) {
            const auto& value = row.of(geometry);
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, BlobRef>) {
                if (!value.empty()) per_vertex(value.byte_size, array.bytes(), {row.name});
            } else {
                for (std::size_t i = 0; i < value.size(); ++i)
                    per_vertex(value[i].byte_size, array.bytes(), {row.name, {}, i, true});
            }
        }
    });
    const std::size_t positions = geometry.motion_positions.size(), normals = geometry.motion_normals.size();
    if (normals != 0 && (normals != positions || geometry.normals.empty()))
        check.add("motion_normals has " + std::to_string(normals) + " entries, motion_positions " +
                  std::to_string(positions) + ": they need as many, and normals to begin with");
}

void check_together(const Material& material, Check& check) {
    const float index = material.index_of_refraction;
    if (index > 0.0f && index < 1.0f)
        check.add("index_of_refraction is " + text_of(index) + ": it has to be 0 or from 1 to 100");
}

void check_together(const Texture& texture, Check& check) {
    const std::uint64_t texel = texture.format == TexelFormat::RgbFloat ? 12 : 4;
    if (texture.texels.byte_size != std::uint64_t{texture.width} * texture.height * texture.depth * texel)
        check.add("texels has " + std::to_string(texture.texels.byte_size) +
                  " bytes: it needs width x height x depth x " + std::to_string(texel));
}

void check_together(const Light& light, Check& check) {
    if (light.kind == LightKind::Spot && light.inner_cone_angle > light.outer_cone_angle)
        check.add("inner_cone_angle is wider than outer_cone_angle: exchange them");
}

void check_together(const Background& background, Check& check) {
    const float alpha = background.visible_color.w;
    if (alpha > 1.0f) check.add("visible_color's alpha is " + text_of(alpha) + ": it has to be from 0 to 1");
}

template <class T>
void check_together(const T&, Check&) {}

}  // namespace

std::string text_of(const Range& range) {
    if (range.minimum == Finite.minimum) return "finite";
    if (range.exclusive) return "between " + text_of(range.minimum) + " and " + text_of(range.maximum);
    if (range.maximum >= Unbounded) return "at least " + text_of(range.minimum) + " and finite";
    return "from " + text_of(range.minimum) + " to " + text_of(range.maximum);
}

std::string describe(ObjectId id, const Object& object) {
    std::string text = std::string(name(kind(object))) + " " + std::to_string(id.value);
    if (const std::string& given = name(object); !given.empty()) text += " ('" + given.substr(0, 64) + "')";
    return text;
}

std::vector<std::string> causes_of(const Object& object) {
    Check check;
    std::visit(
        [&](const auto& value) {
            check.fields(value);
            check_together(value, check);
        },
        object);
    return check.take();
}

std::vector<std::string> problems_of(ObjectId id, const Object& object) {
    std::vector<std::string> problems = causes_of(object);
    for (std::string& problem : problems) problem = describe(id, object) + ": " + problem;
    return problems;
}

}  // namespace tessera::scene
