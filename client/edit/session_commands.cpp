#include <charconv>
#include <chrono>
#include <cmath>
#include <ctime>
#include <utility>

#include "client/edit/command_functions.h"
#include "client/edit/script_error.h"
#include "client/edit/values.h"

namespace tessera::edit {
namespace {

constexpr double MaxWaitSeconds = 86400.0;

std::uint64_t read_count(const Word& word) {
    std::uint64_t value = 0;
    const std::string& text = word.text();
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() || value == 0) {
        throw ScriptError(word.column(), "'" + text + "' is not a positive whole number: see 'help'");
    }
    return value;
}

std::string clock_text(std::int64_t nanoseconds) {
    const auto seconds = static_cast<std::time_t>(nanoseconds / 1'000'000'000);
    std::tm parts{};
    if (gmtime_r(&seconds, &parts) == nullptr) return "?";
    char text[32];
    const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%SZ", &parts);
    return {text, length};
}

std::string log_text(const std::vector<HistoryLine>& lines) {
    std::string text;
    for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
        text += std::to_string(line->number) + "  " + clock_text(line->time) + "  " + in_quotes(line->name) +
                "  " + line->text;
        if (line->undoes != 0) text += "  (undoes " + std::to_string(line->undoes) + ")";
        if (line->undone_by != 0) text += "  (undone by " + std::to_string(line->undone_by) + ")";
        text += "\n";
    }
    return text.empty() ? "no transactions yet\n" : text;
}

std::vector<ObjectId> read_all(const DryRun& dry_run, const Arguments& arguments) {
    std::vector<ObjectId> ids;
    for (const Word& path : arguments) ids.push_back(dry_run.read(path));
    return ids;
}

Expected<std::string> without_output(const Expected<void>& done) {
    if (!done) return tl::unexpected<Error>(done.error());
    return std::string();
}

Expected<std::string> with_label(const char* what, const Expected<std::string>& done) {
    if (!done) return done;
    return std::string(what) + ": " + *done + "\n";
}

}  // namespace

void undo_transaction(DryRun& dry_run, const Arguments& arguments, std::size_t) {
    std::optional<std::uint64_t> number;
    if (!arguments.empty()) number = read_count(arguments[0]);
    dry_run.mark_scene_unknown();
    dry_run.add_action([number](EditTarget& target) { return with_label("undone", target.undo(number)); });
}

void redo_transaction(DryRun& dry_run, const Arguments&, std::size_t) {
    dry_run.mark_scene_unknown();
    dry_run.add_action([](EditTarget& target) { return with_label("redone", target.redo()); });
}

void show_log(DryRun& dry_run, const Arguments& arguments, std::size_t) {
    constexpr std::uint64_t Usual = 10, Most = 10'000;
    const auto count =
        static_cast<std::uint32_t>(arguments.empty() ? Usual : std::min(read_count(arguments[0]), Most));
    dry_run.add_action([count](EditTarget& target) -> Expected<std::string> {
        const auto lines = target.history(count);
        if (!lines) return tl::unexpected<Error>(lines.error());
        return log_text(*lines);
    });
}

void lock_objects(DryRun& dry_run, const Arguments& arguments, std::size_t) {
    const std::vector<ObjectId> ids = read_all(dry_run, arguments);
    dry_run.add_action([ids](EditTarget& target) { return without_output(target.lock(ids)); });
}

void unlock_objects(DryRun& dry_run, const Arguments& arguments, std::size_t) {
    const std::vector<ObjectId> ids = read_all(dry_run, arguments);
    dry_run.add_action([ids](EditTarget& target) { return without_output(target.unlock(ids)); });
}

void show_members(DryRun& dry_run, const Arguments&, std::size_t) {
    dry_run.add_action([](EditTarget& target) -> Expected<std::string> {
        const auto members = target.members();
        if (!members) return tl::unexpected<Error>(members.error());
        const PathIndex path_index(target.scene());
        std::string text;
        for (const Member& member : *members) {
            text += in_quotes(member.name) + (member.user.empty() ? "" : " (" + member.user + ")") +
                    (member.editor ? ", editor" : ", viewer");
            if (!member.text.empty()) text += ": " + member.text;
            for (std::size_t i = 0; i < member.locked.size(); ++i) {
                text += (i == 0 ? "; holds " : ", ") + path_index.path(target.scene(), member.locked[i]);
            }
            text += "\n";
        }
        return text.empty() ? "no members\n" : text;
    });
}

void begin_transaction(DryRun& dry_run, const Arguments&, std::size_t) {
    dry_run.begin();
}

void commit_transaction(DryRun& dry_run, const Arguments&, std::size_t) {
    dry_run.commit();
}

void roll_back(DryRun& dry_run, const Arguments&, std::size_t) {
    dry_run.rollback();
}

void wait_seconds(DryRun& dry_run, const Arguments& arguments, std::size_t) {
    const double seconds = read_number(arguments[0]);
    if (!(seconds >= 0.0 && seconds <= MaxWaitSeconds)) {
        throw ScriptError(arguments[0].column(), "'wait' takes 0 to 86400 seconds");
    }
    const auto duration = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
    dry_run.add_action([duration](EditTarget& target) { return without_output(target.wait(duration)); });
}

void close_scene(DryRun& dry_run, const Arguments&, std::size_t) {
    dry_run.mark_scene_unknown();
    dry_run.add_action([](EditTarget& target) { return without_output(target.close()); });
    dry_run.quit();
}

void quit(DryRun& dry_run, const Arguments&, std::size_t) {
    dry_run.quit();
}

}  // namespace tessera::edit
