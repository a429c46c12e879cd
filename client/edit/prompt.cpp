#include "client/edit/prompt.h"

#include <histedit.h>

#include <algorithm>
#include <clocale>
#include <cstdlib>

namespace tessera::edit {
namespace {

constexpr int MaxHistory = 1000;

// libedit counts in characters of the line, which it holds wide; its narrow view is UTF-8.
int characters(std::string_view text) {
    return static_cast<int>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string common_start(const std::vector<std::string>& texts) {
    std::string start = texts.front();
    for (const std::string& text : texts) {
        const auto [end, unused] = std::mismatch(start.begin(), start.end(), text.begin(), text.end());
        start.erase(end, start.end());
    }
    while (!start.empty() && (static_cast<unsigned char>(start.back()) & 0xc0) == 0x80) start.pop_back();
    if (!start.empty() && static_cast<unsigned char>(start.back()) >= 0xc0) start.pop_back();
    return start;
}

}  // namespace

std::filesystem::path default_history_file() {
    if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state == '/') {
        return std::filesystem::path(state) / "tessera" / "edit_history";
    }
    const char* home = std::getenv("HOME");
    if (home == nullptr || *home != '/') return {};
    return std::filesystem::path(home) / ".local" / "state" / "tessera" / "edit_history";
}

struct Prompt::Implementation {
    Implementation(std::FILE* input, std::FILE* output, std::filesystem::path file, Complete completer)
        : out(output), history_file(std::move(file)), complete(std::move(completer)) {
        std::setlocale(LC_CTYPE, "");
        lines = history_init();
        line = el_init("tessera", input, output, output);
        HistEvent event;
        history(lines, &event, H_SETSIZE, MaxHistory);
        history(lines, &event, H_SETUNIQUE, 1);
        if (!history_file.empty()) {
            std::error_code error;
            std::filesystem::create_directories(history_file.parent_path(), error);
            history(lines, &event, H_LOAD, history_file.c_str());
        }
        el_set(line, EL_CLIENTDATA, this);
        el_set(line, EL_EDITOR, "emacs");
        el_set(line, EL_PROMPT, &Implementation::prompt_text);
        el_set(line, EL_SIGNAL, 0);
        el_set(line, EL_SETTY, "-d", "-isig", nullptr);  // while a line is edited
        el_set(line, EL_HIST, history, lines);
        el_set(line, EL_ADDFN, "tessera-complete", "complete", &Implementation::on_tab);
        el_set(line, EL_ADDFN, "tessera-clear", "clear the line", &Implementation::on_interrupt);
        el_set(line, EL_BIND, "^I", "tessera-complete", nullptr);
        el_set(line, EL_BIND, "^C", "tessera-clear", nullptr);
        el_set(line, EL_BIND, "^R", "em-inc-search-prev", nullptr);
    }
    ~Implementation() {
        el_end(line);
        history_end(lines);
    }
    Implementation(const Implementation&) = delete;
    Implementation& operator=(const Implementation&) = delete;

    static Implementation& of(EditLine* line) {
        void* data = nullptr;
        el_get(line, EL_CLIENTDATA, &data);
        return *static_cast<Implementation*>(data);
    }
    static char* prompt_text(EditLine* line) { return of(line).prompt.data(); }

    static unsigned char on_interrupt(EditLine* line, int) {
        const LineInfo* info = el_line(line);
        const std::string_view text(info->buffer, static_cast<std::size_t>(info->lastchar - info->buffer));
        const std::string_view after_cursor(info->cursor,
                                            static_cast<std::size_t>(info->lastchar - info->cursor));
        std::fputs("^C\n", of(line).out);
        const int all = characters(text);
        el_cursor(line, characters(after_cursor));
        el_deletestr(line, all);
        el_insertstr(line, "\n");
        return CC_NEWLINE;
    }

    static unsigned char on_tab(EditLine* line, int) {
        const LineInfo* info = el_line(line);
        const std::string text(info->buffer, static_cast<std::size_t>(info->lastchar - info->buffer));
        return of(line).tab(text, static_cast<std::size_t>(info->cursor - info->buffer));
    }

    unsigned char tab(const std::string& text, std::size_t cursor) {
        const Completion found = complete(text, cursor);
        if (found.candidates.empty()) return CC_REFRESH_BEEP;
        const std::string typed = text.substr(found.begin, cursor - found.begin);
        const std::string start = common_start(found.candidates);
        const bool is_only = found.candidates.size() == 1;
        if (is_only || (start.size() > typed.size() && start.starts_with(typed))) {
            el_deletestr(line, characters(typed));
            el_insertstr(line, start.c_str());
            return CC_REFRESH;
        }
        std::fputs("\n", out);
        for (const std::string& candidate : found.candidates) std::fprintf(out, "%s\n", candidate.c_str());
        return CC_REDISPLAY;
    }

    void remember(const std::string& text) {
        if (text.find_first_not_of(" \t") == std::string::npos) return;
        HistEvent event;
        history(lines, &event, H_ENTER, text.c_str());
        if (!history_file.empty()) history(lines, &event, H_SAVE, history_file.c_str());
    }

    std::FILE* out;
    std::filesystem::path history_file;
    Complete complete;
    History* lines = nullptr;
    EditLine* line = nullptr;
    std::string prompt;
};

Prompt::Prompt(std::FILE* in, std::FILE* out, std::filesystem::path history_file, Complete complete)
    : implementation_(
          std::make_unique<Implementation>(in, out, std::move(history_file), std::move(complete))) {}

Prompt::~Prompt() = default;

std::optional<std::string> Prompt::read(const std::string& prompt) {
    implementation_->prompt = prompt;
    int count = 0;
    const char* text = el_gets(implementation_->line, &count);
    if (text == nullptr || count <= 0) return std::nullopt;
    std::string line(text, static_cast<std::size_t>(count));
    while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.pop_back();
    implementation_->remember(line);
    return line;
}

}  // namespace tessera::edit
