#include "client/edit/help.h"

#include "client/edit/commands.h"
#include "client/edit/path_book.h"
#include "client/edit/script_error.h"
#include "client/edit/values.h"
#include "client/edit/verbs.h"
#include "mediator/base/nearest.h"
#include "mediator/scene/fields.h"

namespace tessera::edit {
namespace {

constexpr std::string_view Paths =
    R"(Paths
  KIND/NAME      materials/red, transforms/wheel, lights/key
  KIND/NAME@ID   the same object whatever others are named: materials/red@70012
  KIND/@ID       an object without a name
  root           where the tree starts
  none           no object, as a value
Kinds: transforms, geometries, materials, textures, lights, cameras, backgrounds, attachments ('material' works as
well as 'materials'). Paths with an id always work and never change their meaning; the short ones are shown where
they are unique. Names with blanks or " \ # @ = , * ? go into quotes: materials/"my red". Inside and outside of
quotes \ takes the meaning from the next character; \n, \t and \xHH are a new line, a tab and a byte.
)";

constexpr std::string_view Values =
    R"(Values
  numbers        0.8  -1e3; finite. Vectors with blanks or commas between them: 0.8 0.1 0.1 or 0.8,0.1,0.1
  colours        linear Rec. 709; one number is grey. base_color has alpha, which stays when only three are given;
                 'diffuse' is another name for it
  truth          true false, yes no, on off, 1 0
  choices        by name: spot, opaque, clamp ('help KIND' lists them)
  texts          one word, or in quotes: "made by hand"
  references     a path, or none. Children: several paths
  textures       textures/wood offset=0,0 scale=2,2 rotation=0.5; each part may be left out and then stays
  matrices       identity, or 16 numbers column by column; the last row is 0 0 0 1
Metres; radians in fields, degrees in 'rotate'. Arrays and texels cannot be typed: they come with 'load'.
)";

constexpr std::string_view Scripts =
    R"(Scripts
One command a line; # at the start of a word makes the rest a comment. A script is one transaction, or several when
there are 'commit' lines. It is rehearsed in full before the master hears of it: a script with a mistake in line 40
has changed nothing. Then its transactions are sent in order; when the master refuses one, those before it are taken
back. What a line does besides editing (print, save, lock, wait) happens when the edits before it in its transaction
have been taken. Behind 'undo' and 'redo' no line may read or edit the scene, since it cannot be rehearsed.
Errors name file, line and column.
)";

// Lines after the first are indented by `more` beyond the others.
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
    std::string text = "Commands, one a line:\n";
    for (const Command& command : commands()) {
        text += "  " + padded(command.usage, 48) + std::string(command.summary) + "\n";
    }
    return text +
           "'help COMMAND' says more; 'help materials' and the other kinds list their fields; 'help paths', "
           "'help "
           "values' and\n'help scripts' explain these; 'help all' is the whole manual.\n";
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

void show_help(Rehearsal& rehearsal, const Arguments& arguments, std::size_t) {
    const std::string topic = arguments.empty() ? "" : arguments[0].text();
    std::string text = help_text(topic);
    if (text.empty()) {
        std::vector<std::string> candidates = help_topics();
        for (const Command& command : commands()) candidates.emplace_back(command.name);
        candidates.insert(candidates.end(), kind_words().begin(), kind_words().end());
        const auto best = nearest(topic, candidates);
        throw ScriptError(arguments[0].column(),
                          "there is no help about '" + topic + "'" +
                              (best ? "; did you mean '" + *best + "'?" : ": see 'help'"));
    }
    rehearsal.print(std::move(text));
}

}  // namespace tessera::edit
