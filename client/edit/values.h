#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/edit/words.h"
#include "mediator/scene/objects.h"

// The fields of objects as text.
namespace tessera::edit {

// By the name in its row; `diffuse` is another one for a material's base_color.
std::optional<unsigned> find_field(scene::ObjectKind kind, std::string_view name);
unsigned read_field(scene::ObjectKind kind, const Word& name);  // throws ScriptError with the nearest one
std::vector<std::string> field_names(scene::ObjectKind kind);
std::vector<unsigned> fields_of(scene::ObjectKind kind);  // their indices, in the order of the rows

// Reads the words as the field's new value. Numbers may stand in one word with commas between them. What a
// value leaves out stays: alpha behind three numbers, the parts of a texture slot that are not named. Throws
// ScriptError.
using ReadPath = std::function<ObjectId(const Word&)>;
void read_value(scene::Object& object, unsigned field, const std::vector<Word>& words, std::size_t end_column,
                const ReadPath& read_path);

// So that read_value reads it back to the bit (blobs: how many bytes they have).
using WritePath = std::function<std::string(ObjectId)>;
std::string value_text(const scene::Object& object, unsigned field, const WritePath& write_path);

// What may be written for a field: for help and for completion.
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
