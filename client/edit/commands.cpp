#include "client/edit/commands.h"

#include "client/edit/script_error.h"
#include "mediator/base/nearest.h"
#include "mediator/base/old_names.h"

namespace tessera::edit {
namespace {

std::size_t end_column(std::string_view line) {
    while (!line.empty() && (line.back() == ' ' || line.back() == '\t' || line.back() == '\r'))
        line.remove_suffix(1);
    std::size_t column = 1;
    for (const char c : line) column += (static_cast<unsigned char>(c) & 0xc0) == 0x80 ? 0 : 1;
    return column;
}

}  // namespace

const Command* find_command(std::string_view name) {
    const std::string_view present = present_name("edit command", name).value_or(name);
    for (const Command& command : commands()) {
        if (command.name == present) return &command;
    }
    return nullptr;
}

const Command& read_command(const Word& word) {
    if (const Command* command = find_command(word.text())) return *command;
    std::vector<std::string> names;
    for (const Command& command : commands()) names.emplace_back(command.name);
    const auto best = nearest(word.text(), names);
    throw ScriptError(word.column(), "there is no command '" + word.text() + "'" +
                                         (best ? "; did you mean '" + *best + "'?" : ": see 'help'"));
}

std::optional<Word> take_keyword(std::vector<Word>& arguments, std::string_view keyword,
                                 std::size_t end_column) {
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        if (!arguments[i].is(keyword)) continue;
        if (i + 1 == arguments.size()) {
            throw ScriptError(end_column,
                              "'" + std::string(keyword) + "' needs the path of a transform after it");
        }
        if (i + 2 < arguments.size()) {
            throw ScriptError(arguments[i + 2].column(), "unexpected '" + arguments[i + 2].text() +
                                                             "' after '" + std::string(keyword) + " PARENT'");
        }
        const Word path = arguments[i + 1];
        arguments.resize(i);
        return path;
    }
    return std::nullopt;
}

void run_line(DryRun& dry_run, std::string_view line) {
    std::vector<Word> words = split(line);
    if (words.empty()) return;
    const Command& command = read_command(words[0]);
    if (!words[0].is(command.name)) dry_run.print(old_name_hint(words[0].text(), command.name));
    const std::size_t end = end_column(line);
    words.erase(words.begin());
    std::size_t count = words.size();
    if (!command.keyword.empty()) {
        for (std::size_t i = 0; i < words.size(); ++i) {
            if (words[i].is(command.keyword)) count = std::min(count, i);
        }
    }
    if (count < command.min_arguments) {
        throw ScriptError(
            end, "'" + std::string(command.name) + "' needs more arguments: " + std::string(command.usage));
    }
    if (count > command.max_arguments) {
        throw ScriptError(words[command.max_arguments].column(), "unexpected argument '" +
                                                                     words[command.max_arguments].text() +
                                                                     "': " + std::string(command.usage));
    }
    command.run(dry_run, words, end);
}

}  // namespace tessera::edit
