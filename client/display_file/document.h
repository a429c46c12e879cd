#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mediator/base/error.h"

// A TOML file as a tree of values with their source positions.
namespace tessera::display_file {

struct SourcePosition {
    std::uint32_t line = 0, column = 0;
};

struct TableEntry;

// One value of the file.
struct Value {
    enum class Kind { Table, List, Text, Number, Truth, Date };
    Kind kind = Kind::Table;
    SourcePosition position;
    double number = 0.0;  // Truth: 0 or 1
    bool is_whole = false;
    std::string text;
    std::vector<Value> list;
    std::vector<TableEntry> table;  // in the file's order
};

struct TableEntry {
    std::string key;
    Value value;
};

std::string_view kind_name(Value::Kind kind);  // "a table", "a number", ...

// An error with the prefix "wall.toml:12:3: ".
Error error_at(const std::string& file, const SourcePosition& position, const std::string& what);

// A display file of at most 4 MiB. Throws Error{NotFound, InvalidInput, Io}.
std::string read_text(const std::string& path);

// `path` is what errors name. Throws Error{InvalidInput} when the text is not TOML.
Value parse_document(std::string_view text, const std::string& path);

}  // namespace tessera::display_file
