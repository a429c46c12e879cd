#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mediator/base/error.h"

// A TOML file as a tree of values that know where they stand.
namespace tessera::display_file {

struct Place {
    std::uint32_t line = 0, column = 0;
};

struct TableEntry;

// One value of the file, of the kind that it was written as.
struct Value {
    enum class Kind { Table, List, Text, Number, Truth, Date };
    Kind kind = Kind::Table;
    Place place;
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

// "wall.toml:12:3: " in front of what is wrong there.
Error error_at(const std::string& file, const Place& place, const std::string& what);

// A display file of at most 4 MiB. Throws Error{NotFound, InvalidInput, Io}.
std::string read_text(const std::string& path);

// `path` is what errors name. Throws Error{InvalidInput} when the text is no TOML.
Value parse_document(std::string_view text, const std::string& path);

}  // namespace tessera::display_file
