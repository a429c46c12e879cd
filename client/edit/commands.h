#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/edit/rehearsal.h"

namespace tessera::edit {

// What may stand at a place behind a command; completion goes by it.
enum class Argument {
    Path,       // of an object
    Transform,  // path of a transform
    Field,      // PATH.FIELD
    Value,      // of that field
    Kind,
    KindOrPath,
    NewName,
    Assignments,  // field=value ...
    File,
    SaveFile,  // .glb or .tessera
    Free,      // a number, a pattern, a text
    Topic      // a command, a kind or a topic of help
};

// One command, in one place: what is read, what help says, what is completed, what it does.
struct Command {
    std::string_view name, usage, summary, details;
    std::size_t least = 0, most = 0;  // arguments, without the keyword's
    std::vector<Argument> arguments;  // the last one repeats
    std::string_view keyword;         // "in" or "from", and a parent's path behind it, both optional
    void (*run)(Rehearsal&, const std::vector<Word>& arguments, std::size_t end_column) = nullptr;
};

const std::vector<Command>& commands();
const Command* find_command(std::string_view name);
const Command& read_command(const Word& word);  // throws ScriptError with the nearest one

// Splits a keyword and its path off: the path, or nothing. Throws ScriptError when there is no path, or more
// than one.
std::optional<Word> take_keyword(std::vector<Word>& arguments, std::string_view keyword,
                                 std::size_t end_column);

// Checks the number of arguments and runs the line; throws ScriptError.
void run_line(Rehearsal& rehearsal, std::string_view line);

}  // namespace tessera::edit
