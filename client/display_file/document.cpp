#include "client/display_file/document.h"

#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace tessera::display_file {

namespace {

constexpr std::uintmax_t MaxBytes = 4 << 20;
constexpr std::size_t MaxDepth = 16;

bool is_before(const SourcePosition& a, const SourcePosition& b) {
    return a.line != b.line ? a.line < b.line : a.column < b.column;
}

SourcePosition source_position(const toml::source_region& region) {
    return {region.begin.line, region.begin.column};
}

Value converted(const toml::node& node, const std::string& path, std::size_t depth) {
    Value value;
    value.position = source_position(node.source());
    if (depth > MaxDepth) throw error_at(path, value.position, "tables and lists are nested too deeply");
    if (const auto* table = node.as_table()) {
        for (const auto& [key, inner] : *table) {
            value.table.push_back({std::string(key.str()), converted(inner, path, depth + 1)});
            // A list of tables has no source position, and the key's position is clearer than the value's.
            value.table.back().value.position = source_position(key.source());
        }
        std::ranges::stable_sort(value.table, is_before,
                                 [](const auto& entry) { return entry.value.position; });
    } else if (const auto* array = node.as_array()) {
        value.kind = Value::Kind::List;
        for (const toml::node& element : *array) value.list.push_back(converted(element, path, depth + 1));
    } else if (const auto* text = node.as_string()) {
        value.kind = Value::Kind::Text;
        value.text = text->get();
    } else if (const auto* whole = node.as_integer()) {
        value.kind = Value::Kind::Number;
        value.is_whole = true;
        value.number = double(whole->get());
    } else if (const auto* real = node.as_floating_point()) {
        value.kind = Value::Kind::Number;
        value.number = real->get();
    } else if (const auto* truth = node.as_boolean()) {
        value.kind = Value::Kind::Truth;
        value.number = truth->get() ? 1.0 : 0.0;
    } else {
        value.kind = Value::Kind::Date;
    }
    return value;
}

}  // namespace

std::string_view kind_name(Value::Kind kind) {
    switch (kind) {
        case Value::Kind::Table:
            return "a table";
        case Value::Kind::List:
            return "a list";
        case Value::Kind::Text:
            return "a text";
        case Value::Kind::Number:
            return "a number";
        case Value::Kind::Truth:
            return "true or false";
        case Value::Kind::Date:
            break;
    }
    return "a date";
}

Error error_at(const std::string& file, const SourcePosition& position, const std::string& what) {
    return {ErrorCode::InvalidInput,
            file + ":" + std::to_string(position.line) + ":" + std::to_string(position.column) + ": " + what};
}

Value parse_document(std::string_view text, const std::string& path) {
    try {
        const toml::table table = toml::parse(text, path);
        return converted(table, path, 0);
    } catch (const toml::parse_error& error) {
        throw error_at(path, source_position(error.source()),
                       "this is not valid TOML: " + std::string(error.description()));
    }
}

std::string read_text(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        throw Error(ErrorCode::NotFound, "no display file '" + path + "'; check the name");
    if (std::filesystem::file_size(path, error) > MaxBytes)
        throw Error(ErrorCode::InvalidInput, "'" + path + "' has more than 4 MiB: it is not a display file");
    std::ifstream file(path, std::ios::binary);
    std::string text(std::istreambuf_iterator<char>(file), {});
    if (!file) throw Error(ErrorCode::Io, "cannot read '" + path + "'; check its permissions");
    return text;
}

}  // namespace tessera::display_file
