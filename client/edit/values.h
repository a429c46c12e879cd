#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/edit/tokenizer.h"
#include "mediator/scene/objects.h"

// The fields of objects as text.
namespace tessera::edit {

// By its name; `diffuse` is an alias of a material's base_color.
std::optional<unsigned> find_field(scene::ObjectKind kind, std::string_view name);
unsigned read_field(scene::ObjectKind kind,
                    const Word& name);  // throws ScriptError, suggesting the nearest name
std::vector<std::string> field_names(scene::ObjectKind kind);
std::vector<unsigned> fields_of(scene::ObjectKind kind);  // their indices, in the order of the rows

// Reads the words as the field's new value. Numbers may be joined by commas. Omitted parts are kept: alpha after
// three numbers, unnamed parts of a texture slot. Throws ScriptError.
using ReadPath = std::function<ObjectId(const Word&)>;
void read_value(scene::Object& object, unsigned field, const std::vector<Word>& words, std::size_t end_column,
                const ReadPath& read_path);

// read_value(value_text(x)) == x exactly (for blobs: their size only).
using WritePath = std::function<std::string(ObjectId)>;
std::string value_text(const scene::Object& object, unsigned field, const WritePath& write_path);

// The accepted syntax of a field, for help and completion.
struct ValueForm {
    std::string text;                // "3 or 4 numbers", "opaque, mask or blend"
    std::string notes;               // ", from 0 to 1; half angle"
    std::vector<std::string> words;  // enumerators, true and false, none, identity, offset= ...
    bool takes_paths = false;
    bool is_settable = true;
};
ValueForm value_form(scene::ObjectKind kind, unsigned field);

double read_number(const Word& word);   // finite; throws ScriptError
std::string number_text(double value);  // shortest that reads back

scene::Object default_object(scene::ObjectKind kind);

}  // namespace tessera::edit
