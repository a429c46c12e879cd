#include "client/edit/command_functions.h"
#include "client/edit/commands.h"

namespace tessera::edit {

namespace {

constexpr std::size_t Any = 1'000'000;

using enum Argument;

const std::vector<Command> Table{
    {.name = "list",
     .usage = "list [KIND | PATTERN]",
     .summary = "list object paths",
     .details =
         "Lists all objects, all objects of one kind, or all objects whose path matches a pattern: list"
         " materials, list lights/k*, list */wheel. In a pattern, * matches any characters and ? matches "
         "one.",
     .max_arguments = 1,
     .arguments = {KindOrPath},
     .run = list_objects},
    {.name = "show",
     .usage = "show PATH",
     .summary = "show all fields of an object",
     .details =
         "Prints each field in the syntax of 'set', followed by # and who wrote it last in which transaction."
         " For arrays and texels, only the size is shown.",
     .min_arguments = 1,
     .max_arguments = 1,
     .arguments = {Path},
     .run = show_object},
    {.name = "find",
     .usage = "find PATTERN",
     .summary = "find objects by name",
     .details = "Lists the paths of all objects of any kind whose name matches the pattern (* and ?).",
     .min_arguments = 1,
     .max_arguments = 1,
     .arguments = {Free},
     .run = find_objects},
    {.name = "tree",
     .usage = "tree [PATH]",
     .summary = "show the scene hierarchy",
     .details =
         "The tree below the root, or below PATH. Objects with several parents are expanded only once.",
     .max_arguments = 1,
     .arguments = {Path},
     .run = show_tree},
    {.name = "set",
     .usage = "set PATH.FIELD VALUE...",
     .summary = "set a field",
     .details = "'help KIND' lists the fields and their types, 'help values' the syntax of values. Parts "
                "that a value "
                "omits keep their current setting: set materials/red.diffuse 0.8 0.1 0.1 keeps "
                "alpha, set materials/red.base_color_texture scale=2,2 keeps the texture.",
     .min_arguments = 2,
     .max_arguments = Any,
     .arguments = {Field, Value},
     .run = set_field},
    {.name = "move",
     .usage = "move PATH X Y Z",
     .summary = "translate a transform",
     .details = "Moves it relative to its current position, in metres along its parent's axes.",
     .min_arguments = 2,
     .max_arguments = 4,
     .arguments = {Transform, Free},
     .run = move_transform},
    {.name = "rotate",
     .usage = "rotate PATH x|y|z DEGREES",
     .summary = "rotate a transform",
     .details =
         "Rotates it about its own origin, around one of its parent's axes (x, y, z) or a direction of "
         "three numbers (rotate PATH X Y Z DEGREES). Counter-clockwise when the axis points towards "
         "the viewer.",
     .min_arguments = 3,
     .max_arguments = 5,
     .arguments = {Transform, Free},
     .run = rotate_transform},
    {.name = "scale",
     .usage = "scale PATH FACTOR | FX FY FZ",
     .summary = "scale a transform",
     .details = "Scales it along its own axes, about its own origin, relative to its current scale.",
     .min_arguments = 2,
     .max_arguments = 4,
     .arguments = {Transform, Free},
     .run = scale_transform},
    {.name = "create",
     .usage = "create KIND NAME [FIELD=VALUE...] [in PARENT]",
     .summary = "create an object",
     .details =
         "Without 'in' it is placed in the root; materials and backgrounds are not placed in the scene graph."
         " Values must not contain blanks; separate numbers by commas: create material red "
         "diffuse=0.8,0.1,0.1 "
         "roughness=0.3. Geometries and textures are created by 'load' only.",
     .min_arguments = 2,
     .max_arguments = Any,
     .arguments = {Kind, NewName, Assignments},
     .keyword = "in",
     .run = create_object},
    {.name = "attach",
     .usage = "attach PATH in PARENT",
     .summary = "add an object to a transform",
     .details = "Its existing parents are kept: an object with several parents is instanced several times.",
     .min_arguments = 1,
     .max_arguments = 1,
     .arguments = {Path},
     .keyword = "in",
     .run = attach_object},
    {.name = "detach",
     .usage = "detach PATH [from PARENT]",
     .summary = "remove an object from a transform",
     .details = "Without 'from', it is removed from all its parents. It stays in the scene and can be "
                "attached again.",
     .min_arguments = 1,
     .max_arguments = 1,
     .arguments = {Path},
     .keyword = "from",
     .run = detach_object},
    {.name = "remove",
     .usage = "remove PATH [-r]",
     .summary = "remove an object",
     .details =
         "References to it are cleared. Objects that only it used stay; with -r they are removed as well.",
     .min_arguments = 1,
     .max_arguments = 2,
     .arguments = {Path},
     .run = remove_object},
    {.name = "load",
     .usage = "load FILE [at=SECONDS] [in PARENT]",
     .summary = "import a scene file",
     .details = "glTF (.gltf, .glb), .obj, .ply, .stl, .x3d or .tessera: its objects are placed in a new "
                "transform with the file's name, in the root or in PARENT. Its background is used if "
                "the scene has none. Nodes, skins and morph targets are posed at SECONDS of its "
                "animations, or in the rest pose.",
     .min_arguments = 1,
     .max_arguments = 2,
     .arguments = {File, Free},
     .keyword = "in",
     .run = load_file},
    {.name = "save",
     .usage = "save FILE.glb | FILE.tessera",
     .summary = "write the scene to a file",
     .details =
         ".tessera stores the scene exactly; .glb is for other programs, with a warning for everything that "
         "cannot be exported. The file is written atomically.",
     .min_arguments = 1,
     .max_arguments = 1,
     .arguments = {SaveFile},
     .run = save_file},
    {.name = "undo",
     .usage = "undo [NUMBER]",
     .summary = "undo a transaction",
     .details =
         "Your latest one, or the one with this number in 'log'. Fields that others have written since "
         "are not changed.",
     .max_arguments = 1,
     .arguments = {Free},
     .run = undo_transaction},
    {.name = "redo",
     .usage = "redo",
     .summary = "redo the transaction you undid last",
     .details = "Reverts your latest undo.",
     .run = redo_transaction},
    {.name = "log",
     .usage = "log [COUNT]",
     .summary = "list the latest transactions",
     .details = "Ten by default; the newest comes last.",
     .max_arguments = 1,
     .arguments = {Free},
     .run = show_log},
    {.name = "lock",
     .usage = "lock PATH...",
     .summary = "lock objects against edits by others",
     .details = "Edits of these objects by other clients are rejected until you unlock them or leave.",
     .min_arguments = 1,
     .max_arguments = Any,
     .arguments = {Path},
     .run = lock_objects},
    {.name = "unlock",
     .usage = "unlock PATH...",
     .summary = "release locked objects",
     .min_arguments = 1,
     .max_arguments = Any,
     .arguments = {Path},
     .run = unlock_objects},
    {.name = "members",
     .usage = "members",
     .summary = "list the members of the scene",
     .details = "Their names, roles and status texts, and the objects they have locked.",
     .run = show_members},
    {.name = "begin",
     .usage = "begin",
     .summary = "start a transaction",
     .details = "At a prompt, each line is a separate transaction; after 'begin',"
                " all lines up to 'commit' are one transaction.",
     .run = begin_transaction},
    {.name = "commit",
     .usage = "commit",
     .summary = "commit the transaction",
     .details = "The master accepts all of it or rejects all of it. See 'help scripts'.",
     .run = commit_transaction},
    {.name = "rollback",
     .usage = "rollback",
     .summary = "discard the transaction",
     .details = "Drops all edits since the last 'commit'.",
     .run = roll_back},
    {.name = "wait",
     .usage = "wait SECONDS",
     .summary = "pause",
     .min_arguments = 1,
     .max_arguments = 1,
     .arguments = {Free},
     .run = wait_seconds},
    {.name = "close",
     .usage = "close",
     .summary = "close the scene for all members",
     .details = "The master drops its objects and views. Save the scene first if it is still needed.",
     .run = close_scene},
    {.name = "help",
     .usage = "help [COMMAND | KIND | TOPIC]",
     .summary = "show help",
     .details = "Topics: paths, values, scripts; 'help all' prints the whole manual.",
     .max_arguments = 1,
     .arguments = {Topic},
     .run = show_help},
    {.name = "quit",
     .usage = "quit",
     .summary = "leave",
     .details = "In a script, the lines after it are not read.",
     .run = quit},
};

}  // namespace

const std::vector<Command>& commands() {
    return Table;
}

}  // namespace tessera::edit
