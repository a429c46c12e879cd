#include "client/edit/commands.h"

#include "client/edit/script_error.h"
#include "client/edit/verbs.h"
#include "mediator/base/nearest.h"

namespace tessera::edit {
namespace {

constexpr std::size_t Any = 1'000'000;

std::size_t end_column(std::string_view line) {
    while (!line.empty() && (line.back() == ' ' || line.back() == '\t' || line.back() == '\r'))
        line.remove_suffix(1);
    std::size_t column = 1;
    for (const char c : line) column += (static_cast<unsigned char>(c) & 0xc0) == 0x80 ? 0 : 1;
    return column;
}

std::vector<Command> make_commands() {
    using enum Argument;
    return {
        {"list",
         "list [KIND | PATTERN]",
         "paths of objects",
         "All objects, those of one kind, or those whose path fits a pattern: list materials, list "
         "lights/k*, list "
         "*/wheel. In a pattern * stands for any characters and ? for one.",
         0,
         1,
         {KindOrPath},
         "",
         list_objects},
        {"show",
         "show PATH",
         "all fields of an object",
         "Each field as 'set' would take it, and behind # who wrote it last, in which transaction. Arrays "
         "and texels "
         "are shown by their size.",
         1,
         1,
         {Path},
         "",
         show_object},
        {"find",
         "find PATTERN",
         "objects by name",
         "Paths of all objects of any kind whose name fits the pattern (* and ?).",
         1,
         1,
         {Free},
         "",
         find_objects},
        {"tree",
         "tree [PATH]",
         "what is in what",
         "The tree below the root, or below PATH. What is placed several times is unfolded once.",
         0,
         1,
         {Path},
         "",
         show_tree},
        {"set",
         "set PATH.FIELD VALUE...",
         "write one field",
         "What a field takes is said by 'help KIND', and how values are written by 'help values'. What a "
         "value leaves "
         "out stays as it is: set materials/red.diffuse 0.8 0.1 0.1 keeps alpha, set "
         "materials/red.base_color_texture scale=2,2 keeps the texture.",
         2,
         Any,
         {Field, Value},
         "",
         set_field},
        {"move",
         "move PATH X Y Z",
         "shift a transform",
         "By so many metres along the axes of what it stands in; added to what there is.",
         2,
         4,
         {Transform, Free},
         "",
         move_transform},
        {"rotate",
         "rotate PATH x|y|z DEGREES",
         "turn a transform",
         "About its own origin, around an axis of what it stands in: x, y, z, or a direction of three "
         "numbers (rotate "
         "PATH X Y Z DEGREES). Counter-clockwise when the axis points at you.",
         3,
         5,
         {Transform, Free},
         "",
         rotate_transform},
        {"scale",
         "scale PATH FACTOR | FX FY FZ",
         "size a transform",
         "Along its own axes, about its own origin; multiplied with what there is.",
         2,
         4,
         {Transform, Free},
         "",
         scale_transform},
        {"create",
         "create KIND NAME [FIELD=VALUE...] [in PARENT]",
         "make an object",
         "Without 'in' it stands in the root; materials and backgrounds stand nowhere. Values have no "
         "blanks, commas "
         "stand between numbers: create material red diffuse=0.8,0.1,0.1 roughness=0.3. Geometries and "
         "textures come "
         "with 'load'.",
         2,
         Any,
         {Kind, NewName, Assignments},
         "in",
         create_object},
        {"attach",
         "attach PATH in PARENT",
         "put an object into a transform",
         "Besides where it is: an object with several places is shown several times.",
         1,
         1,
         {Path},
         "in",
         attach_object},
        {"detach",
         "detach PATH [from PARENT]",
         "take an object out of a transform",
         "Without 'from' out of everything; it stays in the scene and can be attached again.",
         1,
         1,
         {Path},
         "from",
         detach_object},
        {"remove",
         "remove PATH [-r]",
         "remove an object",
         "Whatever refers to it no longer does. What only it used stays; with -r that goes, too.",
         1,
         2,
         {Path},
         "",
         remove_object},
        {"load",
         "load FILE [at=SECONDS] [in PARENT]",
         "bring in a scene file",
         "glTF (.gltf, .glb), .obj, .ply, .stl, .x3d or .tessera: its objects come under a new transform "
         "with "
         "the file's name, in the root or in PARENT. Its background is taken when the scene has none. Nodes, "
         "skins and morph targets are posed at SECONDS of its animations, else at rest.",
         1,
         2,
         {File, Free},
         "in",
         load_file},
        {"save",
         "save FILE.glb | FILE.tessera",
         "write the scene to a file",
         ".tessera holds the scene to the bit; .glb is for other programs and says what it leaves out. The "
         "file "
         "appears in full or not at all.",
         1,
         1,
         {SaveFile},
         "",
         save_file},
        {"undo",
         "undo [NUMBER]",
         "take a transaction back",
         "Your latest one, or the one with this number in 'log'. What others have written since stays "
         "theirs.",
         0,
         1,
         {Free},
         "",
         undo_transaction},
        {"redo",
         "redo",
         "do again what you took back",
         "The latest undo of yours.",
         0,
         0,
         {},
         "",
         redo_transaction},
        {"log",
         "log [COUNT]",
         "the latest transactions",
         "Ten without a number; the youngest is the last line.",
         0,
         1,
         {Free},
         "",
         show_log},
        {"lock",
         "lock PATH...",
         "keep others from changing objects",
         "Their edits of these objects are refused until you unlock them or leave.",
         1,
         Any,
         {Path},
         "",
         lock_objects},
        {"unlock", "unlock PATH...", "let others change them again", "", 1, Any, {Path}, "", unlock_objects},
        {"people",
         "people",
         "who is here",
         "Names, what they say they do, and what they have locked.",
         0,
         0,
         {},
         "",
         show_people},
        {"begin",
         "begin",
         "start a transaction",
         "At a prompt each line is a transaction of its own, unless 'begin' stands before it: then all lines "
         "up to "
         "'commit' are one.",
         0,
         0,
         {},
         "",
         begin_transaction},
        {"commit",
         "commit",
         "finish a transaction",
         "The master takes all of it, or nothing. See 'help scripts'.",
         0,
         0,
         {},
         "",
         commit_transaction},
        {"rollback",
         "rollback",
         "forget a transaction",
         "The edits since the last 'commit' never happen.",
         0,
         0,
         {},
         "",
         roll_back},
        {"wait", "wait SECONDS", "pause", "", 1, 1, {Free}, "", wait_seconds},
        {"close",
         "close",
         "end the scene for everybody",
         "Objects and views go from the master. Save first what is to stay.",
         0,
         0,
         {},
         "",
         close_scene},
        {"help",
         "help [COMMAND | KIND | TOPIC]",
         "explain",
         "Topics: paths, values, scripts, and all for everything.",
         0,
         1,
         {Topic},
         "",
         show_help},
        {"quit", "quit", "leave", "In a script: what stands behind it is not read.", 0, 0, {}, "", quit},
    };
}

}  // namespace

const std::vector<Command>& commands() {
    static const std::vector<Command> All = make_commands();
    return All;
}

const Command* find_command(std::string_view name) {
    for (const Command& command : commands()) {
        if (command.name == name) return &command;
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
                              "'" + std::string(keyword) + "' lacks the path of a transform behind it");
        }
        if (i + 2 < arguments.size()) {
            throw ScriptError(arguments[i + 2].column(), "nothing may stand behind '" + std::string(keyword) +
                                                             " PARENT': '" + arguments[i + 2].text() +
                                                             "' does");
        }
        const Word path = arguments[i + 1];
        arguments.resize(i);
        return path;
    }
    return std::nullopt;
}

void run_line(Rehearsal& rehearsal, std::string_view line) {
    std::vector<Word> words = split(line);
    if (words.empty()) return;
    const Command& command = read_command(words[0]);
    const std::size_t end = end_column(line);
    words.erase(words.begin());
    std::size_t count = words.size();
    if (!command.keyword.empty()) {
        for (std::size_t i = 0; i < words.size(); ++i) {
            if (words[i].is(command.keyword)) count = std::min(count, i);
        }
    }
    if (count < command.least) {
        throw ScriptError(end,
                          "'" + std::string(command.name) + "' needs more: " + std::string(command.usage));
    }
    if (count > command.most) {
        throw ScriptError(words[command.most].column(),
                          "'" + words[command.most].text() + "' is too much: " + std::string(command.usage));
    }
    command.run(rehearsal, words, end);
}

}  // namespace tessera::edit
