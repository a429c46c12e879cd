#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/edit/dry_run.h"

namespace tessera::edit {

// The kind of an argument; used for completion.
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

// Everything about one command: syntax, help, completion and implementation.
struct Command {
    std::string_view name, usage, summary, details;
    std::size_t min_arguments = 0, max_arguments = 0;  // not counting the keyword and its path
    std::vector<Argument> arguments;                   // the last one repeats
    std::string_view keyword;                          // optional "in" or "from", followed by a parent's path
    void (*run)(DryRun&, const std::vector<Word>& arguments, std::size_t end_column) = nullptr;
};

const std::vector<Command>& commands();
const Command* find_command(std::string_view name);
const Command& read_command(const Word& word);  // throws ScriptError, suggesting the nearest name

// Removes a keyword and its path from the arguments; returns the path, if any. Throws ScriptError if the path is
// missing or followed by further arguments.
std::optional<Word> take_keyword(std::vector<Word>& arguments, std::string_view keyword,
                                 std::size_t end_column);

// Checks the number of arguments and runs the line; throws ScriptError.
void run_line(DryRun& dry_run, std::string_view line);

}  // namespace tessera::edit
