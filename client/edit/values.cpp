#include "client/edit/values.h"

#include <charconv>

#include "client/edit/path_index.h"
#include "client/edit/script_error.h"
#include "client/edit/value_reader.h"
#include "mediator/base/nearest.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/validate_object.h"

namespace tessera::edit {
namespace {

using scene::ObjectKind;

std::string alternatives(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i) {
        text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
    }
    return text;
}

template <class V>
ValueForm form_of() {
    if constexpr (std::is_same_v<V, std::string>) {
        return {"a text, quoted if it contains blanks", "", {}};
    } else if constexpr (std::is_same_v<V, bool>) {
        return {"true or false", "", {"true", "false"}};
    } else if constexpr (std::is_same_v<V, std::uint32_t> || std::is_same_v<V, std::int32_t>) {
        return {"a whole number", "", {}};
    } else if constexpr (std::is_arithmetic_v<V>) {
        return {"a number", "", {}};
    } else if constexpr (std::is_same_v<V, glm::vec2>) {
        return {"2 numbers, or 1 for both", "", {}};
    } else if constexpr (std::is_same_v<V, glm::vec3>) {
        return {"3 numbers, or 1 for all", "", {}};
    } else if constexpr (std::is_same_v<V, glm::vec4>) {
        return {"3 or 4 numbers (alpha is kept if omitted)", "", {}};
    } else if constexpr (std::is_same_v<V, glm::dvec3>) {
        return {"3 numbers", "", {}};
    } else if constexpr (std::is_same_v<V, glm::dmat4>) {
        return {"identity, or 16 numbers column by column", "", {"identity"}};
    } else if constexpr (std::is_same_v<V, std::vector<glm::dmat4>>) {
        return {"none, or up to 15 matrices of 16 numbers column by column", "", {"none", "identity"}};
    } else if constexpr (std::is_same_v<V, ObjectId>) {
        return {"a path, or none", "", {"none"}, true};
    } else if constexpr (std::is_same_v<V, std::vector<ObjectId>>) {
        return {"paths, or none", "", {"none"}, true};
    } else if constexpr (std::is_same_v<V, scene::TextureSlot>) {
        return {"a texture's path or none, then offset=U,V scale=U,V rotation=RADIANS set=0|1 (all optional)",
                "",
                {"none", "offset=", "scale=", "rotation=", "set="},
                true};
    } else if constexpr (std::is_same_v<V, scene::BlobRef> ||
                         std::is_same_v<V, std::vector<scene::BlobRef>>) {
        return {"binary data, which cannot be typed: import it with 'load'", "", {}, false, false};
    } else {
        static_assert(std::is_enum_v<V>, "a new type of field needs a form, a reader and a text");
        return {alternatives(enumerator_names<V>()), "", enumerator_names<V>()};
    }
}

template <class N>
std::string shortest(N value) {
    char text[40];
    const auto end = std::to_chars(text, text + sizeof text, value);
    return {text, end.ptr};
}

template <class V>
std::string components(const V& value, const char* separator = " ") {
    std::string text;
    for (glm::length_t i = 0; i < value.length(); ++i) text += (i ? separator : "") + shortest(value[i]);
    return text;
}

template <class V>
std::string text_of(const V& value, const WritePath& write_path) {
    if constexpr (std::is_same_v<V, std::string>) {
        return in_quotes(value);
    } else if constexpr (std::is_same_v<V, bool>) {
        return value ? "true" : "false";
    } else if constexpr (std::is_arithmetic_v<V>) {
        return shortest(value);
    } else if constexpr (std::is_same_v<V, glm::dmat4>) {
        if (value == glm::dmat4(1.0)) return "identity";
        return components(value[0]) + "  " + components(value[1]) + "  " + components(value[2]) + "  " +
               components(value[3]);
    } else if constexpr (std::is_same_v<V, std::vector<glm::dmat4>>) {
        std::string text;
        for (const glm::dmat4& key : value) text += (text.empty() ? "" : "   ") + text_of(key, write_path);
        return text.empty() ? "none" : text;
    } else if constexpr (std::is_same_v<V, ObjectId>) {
        return write_path(value);
    } else if constexpr (std::is_same_v<V, std::vector<ObjectId>>) {
        std::string text;
        for (const ObjectId id : value) text += (text.empty() ? "" : " ") + write_path(id);
        return text.empty() ? "none" : text;
    } else if constexpr (std::is_same_v<V, scene::TextureSlot>) {
        return write_path(value.texture) + " offset=" + components(value.offset, ",") +
               " scale=" + components(value.scale, ",") + " rotation=" + shortest(value.rotation) +
               " set=" + shortest(value.set);
    } else if constexpr (std::is_same_v<V, scene::BlobRef>) {
        return value.empty() ? "no bytes" : std::to_string(value.byte_size) + " bytes";
    } else if constexpr (std::is_same_v<V, std::vector<scene::BlobRef>>) {
        if (value.empty()) return "no bytes";
        return std::to_string(value.size()) + " motion keys of " + std::to_string(value[0].byte_size) +
               " bytes";
    } else if constexpr (std::is_enum_v<V>) {
        const std::string_view name = enumerator_name(value);
        return name.empty() ? std::to_string(static_cast<int>(value)) : std::string(name);
    } else {
        return components(value);
    }
}

// Calls visit(row) for the field's row.
template <class T, class Visitor>
void with_row(unsigned field, const Visitor& visit) {
    for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        if (row_of<T, I>.number - 1 == field) visit(row_of<T, I>);
    });
}

// Calls visit(value) for the field of the object.
template <class O, class Visitor>
void with_field(O& object, unsigned field, const Visitor& visit) {
    std::visit(
        [&]<class T>(T& value) {
            with_row<std::remove_const_t<T>>(field, [&](const auto& row) { visit(row.of(value)); });
        },
        object);
}

// Range, unit and description of the field, each preceded by a comma or a semicolon.
template <class Row>
std::string notes_of(const Row& row) {
    std::string text;
    if constexpr (Row::template has<scene::Range>)
        text += ", " + scene::text_of(row.template note<scene::Range>());
    if constexpr (Row::template has<scene::Unit>)
        text += ", in " + std::string(row.template note<scene::Unit>().symbol);
    if constexpr (Row::template has<scene::Help>)
        text += "; " + std::string(row.template note<scene::Help>().text);
    return text;
}

}  // namespace

scene::Object default_object(ObjectKind kind) {
    scene::Object object;
    scene::with_kind(kind, [&]<class T>() { object = T{}; });
    return object;
}

std::vector<unsigned> fields_of(ObjectKind kind) {
    std::vector<unsigned> fields;
    scene::with_kind(kind, [&]<class T>() {
        scene::for_each_field<T>([&](unsigned index, auto) { fields.push_back(index); });
    });
    return fields;
}

std::vector<std::string> field_names(ObjectKind kind) {
    std::vector<std::string> names;
    for (const unsigned field : fields_of(kind)) names.emplace_back(scene::field_name(kind, field));
    return names;
}

std::optional<unsigned> find_field(ObjectKind kind, std::string_view name) {
    if (kind == ObjectKind::Material && name == "diffuse") name = "base_color";
    for (const unsigned field : fields_of(kind)) {
        if (scene::field_name(kind, field) == name) return field;
    }
    return std::nullopt;
}

unsigned read_field(ObjectKind kind, const Word& name) {
    if (const auto field = find_field(kind, name.text())) return *field;
    std::string all;
    for (const std::string& one : field_names(kind)) all += (all.empty() ? "" : ", ") + one;
    const auto best = nearest(name.text(), field_names(kind));
    throw ScriptError(name.column(), "a " + std::string(scene::name(kind)) + " has no field '" + name.text() +
                                         "'" +
                                         (best ? "; did you mean '" + *best + "'?" : ": it has " + all));
}

ValueForm value_form(ObjectKind kind, unsigned field) {
    ValueForm form;
    scene::with_kind(kind, [&]<class T>() {
        with_row<T>(field, [&](const auto& row) {
            form = form_of<std::decay_t<decltype(row.of(std::declval<T&>()))>>();
            form.notes = notes_of(row);
        });
    });
    return form;
}

void read_value(scene::Object& object, unsigned field, const std::vector<Word>& words, std::size_t end_column,
                const ReadPath& read_path) {
    const ObjectKind kind = scene::kind(object);
    ValueReader reader(words, end_column, value_form(kind, field).text, read_path);
    with_field(object, field, [&](auto& value) { reader.read(value); });
    reader.expect_end();
}

std::string value_text(const scene::Object& object, unsigned field, const WritePath& write_path) {
    std::string text;
    with_field(object, field, [&](const auto& value) { text = text_of(value, write_path); });
    return text;
}

std::string number_text(double value) {
    return shortest(value);
}

}  // namespace tessera::edit
