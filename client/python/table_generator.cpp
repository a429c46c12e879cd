// Writes a module of the package from the rows of scene objects, or of channels. Usage: tessera_table_generator objects|channels
#include <cctype>
#include <charconv>
#include <cstdio>
#include <string>

#include "mediator/frame/channels.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/validate_object.h"

namespace {

using namespace tessera;

constexpr const char* Head =
    R"("""The kinds of scene objects, as values: field names, units and defaults. Metres, radians, linear Rec. 709; world
right-handed, y up; matrices column by column. References are object ids, 0 = none. The build writes this file from
mediator/scene/objects.h and materials.h."""

from __future__ import annotations

from dataclasses import dataclass

from .values import IDENTITY, Blob, FieldRow, KindRow, Matrix, Object, Vec2, Vec3, Vec4

)";

// What Python calls a value of a field: its type, and the codec name of fields.py.
struct PythonType {
    std::string annotation, codec;
};

template <class V, class Row>
PythonType type_of(const Row& row) {
    using namespace std::string_literals;
    const auto array_code = [&]() -> std::string {
        switch (note_or(row, scene::Array{}).element) {
            case scene::Element::Uint32:
                return "I";
            case scene::Element::Float32:
                return "f";
            case scene::Element::Byte:
                return "B";
        }
        return "";
    };
    if constexpr (std::is_same_v<V, std::string>) {
        return {"str", "text"};
    } else if constexpr (std::is_same_v<V, bool>) {
        return {"bool", "bool"};
    } else if constexpr (std::is_enum_v<V>) {
        return {"str", "choice"};
    } else if constexpr (std::is_floating_point_v<V>) {
        return {"float", std::is_same_v<V, float> ? "float" : "double"};
    } else if constexpr (std::is_integral_v<V>) {
        return {"int", std::is_signed_v<V> ? "int" : "uint"};
    } else if constexpr (std::is_same_v<V, ObjectId>) {
        return {"int", "id"};
    } else if constexpr (std::is_same_v<V, std::vector<ObjectId>>) {
        return {"tuple[int, ...]", "ids"};
    } else if constexpr (std::is_same_v<V, scene::TextureSlot>) {
        return {"TextureSlot", "slot"};
    } else if constexpr (std::is_same_v<V, scene::BlobRef>) {
        return {"Blob", "blob " + array_code()};
    } else if constexpr (std::is_same_v<V, std::vector<scene::BlobRef>>) {
        return {"tuple[Blob, ...]", "blobs " + array_code()};
    } else if constexpr (std::is_same_v<V, glm::dmat4>) {
        return {"Matrix", "matrix"};
    } else if constexpr (std::is_same_v<V, std::vector<glm::dmat4>>) {
        return {"tuple[Matrix, ...]", "matrices"};
    } else {
        const std::string length = std::to_string(V::length());
        return {"Vec" + length,
                (std::is_same_v<typename V::value_type, float> ? "float" : "double") + length};
    }
}

template <class N>
std::string number(N value) {
    char text[40];
    std::string shortest(text, std::to_chars(text, text + sizeof text, value).ptr);
    const bool is_whole = shortest.find_first_of(".en") == std::string::npos;
    return std::is_floating_point_v<N> && is_whole ? shortest + ".0" : shortest;
}

template <class V>
std::string value_of(const V& value) {
    if constexpr (std::is_same_v<V, std::string>) {
        return "\"" + value + "\"";
    } else if constexpr (std::is_same_v<V, bool>) {
        return value ? "True" : "False";
    } else if constexpr (std::is_enum_v<V>) {
        return "\"" + std::string(enumerator_name(value)) + "\"";
    } else if constexpr (std::is_arithmetic_v<V>) {
        return number(value);
    } else if constexpr (std::is_same_v<V, ObjectId>) {
        return number(value.value);
    } else if constexpr (std::is_same_v<V, scene::TextureSlot>) {
        return "TextureSlot()";
    } else if constexpr (std::is_same_v<V, scene::BlobRef>) {
        return "Blob()";
    } else if constexpr (std::is_same_v<V, glm::dmat4>) {
        return "IDENTITY";
    } else if constexpr (requires { value.size(); }) {
        return "()";
    } else {
        std::string text;
        for (glm::length_t i = 0; i < V::length(); ++i) text += (i == 0 ? "(" : ", ") + number(value[i]);
        return text + ")";
    }
}

template <class Row>
std::string comment_of(const Row& row) {
    std::string text;
    const auto add = [&](const std::string& part) { text += (text.empty() ? "  # " : "; ") + part; };
    if constexpr (Row::template has<scene::Array>) {
        constexpr const char* Elements[] = {"uint32", "float32", "byte"};
        const auto& array = row.template note<scene::Array>();
        add(std::string(Elements[static_cast<int>(array.element)]) + " x " + number(array.components) +
            (array.is_per_vertex ? " per vertex" : ""));
    }
    if constexpr (Row::template has<scene::Unit>) add(std::string(row.template note<scene::Unit>().symbol));
    if constexpr (Row::template has<scene::Range>) add(scene::text_of(row.template note<scene::Range>()));
    if constexpr (Row::template has<scene::Help>) add(std::string(row.template note<scene::Help>().text));
    return text;
}

// The name of the structure in proto/scene.proto: "surface_shader" is SurfaceShader.
std::string class_name(std::string_view kind) {
    std::string name;
    bool begins = true;
    for (const char c : kind) {
        if (c != '_') name += begins ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        begins = c == '_';
    }
    return name;
}

template <class T>
void write_fields() {
    for_each_row<T>([]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        const auto& row = row_of<T, I>;
        if (row.name == "name") return;  // of every Object
        const auto& value = row.of(initial<T>());
        const PythonType type = type_of<std::decay_t<decltype(value)>>(row);
        std::printf("    %s: %s = %s%s\n", std::string(row.name).c_str(), type.annotation.c_str(),
                    value_of(value).c_str(), comment_of(row).c_str());
    });
}

template <class T>
void write_rows() {
    for_each_row<T>([]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        const auto& row = row_of<T, I>;
        using V = std::decay_t<decltype(row.of(initial<T>()))>;
        std::string choices;
        if constexpr (std::is_enum_v<V>) {
            for (const std::string_view name : enumerators(V{})) choices += "\"" + std::string(name) + "\", ";
        }
        std::printf("        FieldRow(\"%s\", %u, \"%s\"%s),\n", std::string(row.name).c_str(), row.number,
                    type_of<V>(row).codec.c_str(),
                    choices.empty() ? "" : (", (" + choices.substr(0, choices.size() - 2) + ")").c_str());
    });
}

void write_channels() {
    std::printf("\"\"\"Channels of film by their number; written by the build.\"\"\"\n\n");
    std::printf("# name, rule, components\nCHANNEL_ROWS: tuple[tuple[str, str, int], ...] = (\n");
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        std::printf("    (\"%s\", \"%s\", %u),  # %s\n", std::string(entry.name).c_str(),
                    std::string(enumerator_name(entry.rule)).c_str(), entry.components,
                    std::string(entry.meaning).c_str());
    }
    std::printf(")\n");
}

void write_objects() {
    std::printf("%s\n@dataclass(frozen=True)\nclass TextureSlot:\n", Head);
    std::printf(
        "    \"\"\"A texture as a material uses it: uv' = translate(offset) rotate(rotation) scale(scale) uv."
        "\"\"\"\n\n");
    write_fields<scene::TextureSlot>();
    for (const scene::KindRow& kind : scene::Kinds) {
        std::printf("\n\n@dataclass(frozen=True)\nclass %s(Object):\n", class_name(kind.name).c_str());
        scene::with_kind(kind.kind, []<class T>() { write_fields<T>(); });
    }
    std::printf("\n\nTEXTURE_SLOT_ROWS = (\n");
    write_rows<scene::TextureSlot>();
    std::printf(")\nKIND_ROWS = (\n");
    for (const scene::KindRow& kind : scene::Kinds) {
        const bool is_placed = (scene::PlacedKinds & scene::bit(kind.kind)) != 0;
        std::printf("    KindRow(\"%s\", \"%s\", %s, %s, (\n", kind.name, kind.plural,
                    class_name(kind.name).c_str(), is_placed ? "True" : "False");
        scene::with_kind(kind.kind, []<class T>() { write_rows<T>(); });
        std::printf("    )),\n");
    }
    std::printf(")\n");
}

}  // namespace

int main(int, char** argv) {
    std::string_view(argv[1]) == "channels" ? write_channels() : write_objects();
}
