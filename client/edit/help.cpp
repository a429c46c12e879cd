#include "client/edit/help.h"

#include "client/edit/command_functions.h"
#include "client/edit/commands.h"
#include "client/edit/path_index.h"
#include "client/edit/script_error.h"
#include "client/edit/values.h"
#include "mediator/base/nearest.h"
#include "mediator/scene/fields.h"

namespace tessera::edit {
namespace {

constexpr std::string_view Paths =
    R"(Paths
  KIND/NAME      materials/red, transforms/wheel, lights/key
  KIND/NAME@ID   unambiguous even if several objects share the name: materials/red@70012
  KIND/@ID       an object without a name
  root           the root of the scene graph
  none           no object, as a value
Kinds: transforms, geometries, materials, textures, lights, cameras, backgrounds, attachments ('material' works as
well as 'materials'). Paths with an id always work and never change their meaning; short paths are printed where
they are unique. Quote names that contain blanks or " \ # @ = , * ?, as in materials/"my red". Inside and outside of
quotes, \ escapes the next character; \n, \t and \xHH are a new line, a tab and a byte.
)";

constexpr std::string_view Values =
    R"(Values
  numbers        0.8  -1e3; finite. Separate vector components by blanks or commas: 0.8 0.1 0.1 or 0.8,0.1,0.1
  colours        linear Rec. 709; one number is grey. base_color has alpha, which is kept if only three numbers are
                 given; 'diffuse' is an alias of base_color
  booleans       true false, yes no, on off, 1 0
  choices        by name: spot, opaque, clamp ('help KIND' lists them)
  texts          one word, or in quotes: "made by hand"
  references     a path, or none. Children: several paths
  textures       textures/wood offset=0,0 scale=2,2 rotation=0.5; omitted parts are kept
  matrices       identity, or 16 numbers column by column; the last row is 0 0 0 1
Metres; radians in fields, degrees in 'rotate'. Arrays and texels cannot be typed; import them with 'load'.
)";

constexpr std::string_view Scripts =
    R"(Scripts
One command per line; # at the start of a word begins a comment. A script is one transaction, or several separated
by 'commit' lines. The whole script is first run on a copy of the scene (dry run), before anything is sent to the
master: a script with a mistake in line 40 changes nothing. Then its transactions are sent in order; if the master
rejects one, the earlier ones are undone. Other actions of a line (print, save, lock, wait) are executed once the
preceding edits of their transaction have been accepted. After 'undo' or 'redo', no line may read or edit the
scene, since the dry run cannot predict the result. Errors give the file, line and column.
)";

// Lines after the first are indented by `more` additional blanks.
std::string wrapped(std::string_view text, const std::string& first_indent, std::size_t more = 0) {
    constexpr std::size_t Width = 100;
    std::string result, indent = first_indent;
    std::size_t column = 0;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(' '), text.size());
        const std::string_view word = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        if (column > 0 && column + 1 + word.size() > Width) {
            result += "\n";
            column = 0;
            indent = first_indent + std::string(more, ' ');
        }
        result += column == 0 ? indent : " ";
        column += (column == 0 ? indent.size() : 1) + word.size();
        result += word;
    }
    return result.empty() ? result : result + "\n";
}

std::string padded(std::string_view text, std::size_t width) {
    return std::string(text) + std::string(text.size() < width ? width - text.size() : 1, ' ');
}

std::string overview() {
    std::string text = "Commands, one per line:\n";
    for (const Command& command : commands()) {
        text += "  " + padded(command.usage, 48) + std::string(command.summary) + "\n";
    }
    return text +
           "'help COMMAND' gives details; 'help materials' and the other kinds list their fields; 'help "
           "paths', "
           "'help values' and\n'help scripts' explain these topics; 'help all' prints the whole manual.\n";
}

std::string about(const Command& command) {
    return std::string(command.usage) + "\n" + wrapped(std::string(command.summary) + ".", "  ") +
           wrapped(command.details, "  ");
}

std::string about(scene::ObjectKind kind) {
    std::string text = "Fields of " + std::string(kind_word(kind)) + "\n";
    for (const unsigned field : fields_of(kind)) {
        const ValueForm form = value_form(kind, field);
        text += wrapped(padded(scene::field_name(kind, field), 28) + form.text + form.notes, "  ", 28);
    }
    return text;
}

}  // namespace

const std::vector<std::string>& help_topics() {
    static const std::vector<std::string> Topics{"paths", "values", "scripts", "all"};
    return Topics;
}

std::string whole_manual() {
    std::string text = overview();
    for (const Command& command : commands()) text += "\n" + about(command);
    for (const std::string_view part : {Paths, Values, Scripts}) text += "\n" + std::string(part);
    for (const scene::KindRow& row : scene::Kinds) text += "\n" + about(row.kind);
    return text;
}

std::string help_text(std::string_view topic) {
    scene::ObjectKind kind{};
    if (topic.empty()) return overview();
    if (topic == "paths") return std::string(Paths);
    if (topic == "values") return std::string(Values);
    if (topic == "scripts") return std::string(Scripts);
    if (topic == "all") return whole_manual();
    if (const Command* command = find_command(topic)) return about(*command);
    if (is_kind(topic, kind)) return about(kind);
    return {};
}

void show_help(DryRun& dry_run, const Arguments& arguments, std::size_t) {
    const std::string topic = arguments.empty() ? "" : arguments[0].text();
    std::string text = help_text(topic);
    if (text.empty()) {
        std::vector<std::string> candidates = help_topics();
        for (const Command& command : commands()) candidates.emplace_back(command.name);
        candidates.insert(candidates.end(), kind_words().begin(), kind_words().end());
        const auto best = nearest(topic, candidates);
        throw ScriptError(arguments[0].column(),
                          "there is no help topic '" + topic + "'" +
                              (best ? "; did you mean '" + *best + "'?" : ": see 'help'"));
    }
    dry_run.print(std::move(text));
}

}  // namespace tessera::edit
