#include <charconv>
#include <chrono>
#include <cmath>
#include <ctime>
#include <utility>

#include "client/edit/script_error.h"
#include "client/edit/values.h"
#include "client/edit/verbs.h"

namespace tessera::edit {
namespace {

constexpr double LongestWait = 86400.0;

std::uint64_t read_count(const Word& word) {
    std::uint64_t value = 0;
    const std::string& text = word.text();
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() || value == 0) {
        throw ScriptError(word.column(), "'" + text + "' is no whole number from 1: see 'help'");
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
    return text.empty() ? "nothing was done yet\n" : text;
}

std::vector<ObjectId> read_all(const Rehearsal& rehearsal, const Arguments& arguments) {
    std::vector<ObjectId> ids;
    for (const Word& path : arguments) ids.push_back(rehearsal.read(path));
    return ids;
}

Expected<std::string> silent(const Expected<void>& done) {
    if (!done) return tl::unexpected<Error>(done.error());
    return std::string();
}

Expected<std::string> told(const char* what, const Expected<std::string>& done) {
    if (!done) return done;
    return std::string(what) + ": " + *done + "\n";
}

}  // namespace

void undo_transaction(Rehearsal& rehearsal, const Arguments& arguments, std::size_t) {
    std::optional<std::uint64_t> number;
    if (!arguments.empty()) number = read_count(arguments[0]);
    rehearsal.lose_sight();
    rehearsal.act([number](EditTarget& target) { return told("undone", target.undo(number)); });
}

void redo_transaction(Rehearsal& rehearsal, const Arguments&, std::size_t) {
    rehearsal.lose_sight();
    rehearsal.act([](EditTarget& target) { return told("done again", target.redo()); });
}

void show_log(Rehearsal& rehearsal, const Arguments& arguments, std::size_t) {
    constexpr std::uint64_t Usual = 10, Most = 10'000;
    const auto count =
        static_cast<std::uint32_t>(arguments.empty() ? Usual : std::min(read_count(arguments[0]), Most));
    rehearsal.act([count](EditTarget& target) -> Expected<std::string> {
        const auto lines = target.history(count);
        if (!lines) return tl::unexpected<Error>(lines.error());
        return log_text(*lines);
    });
}

void lock_objects(Rehearsal& rehearsal, const Arguments& arguments, std::size_t) {
    const std::vector<ObjectId> ids = read_all(rehearsal, arguments);
    rehearsal.act([ids](EditTarget& target) { return silent(target.lock(ids)); });
}

void unlock_objects(Rehearsal& rehearsal, const Arguments& arguments, std::size_t) {
    const std::vector<ObjectId> ids = read_all(rehearsal, arguments);
    rehearsal.act([ids](EditTarget& target) { return silent(target.unlock(ids)); });
}

void show_people(Rehearsal& rehearsal, const Arguments&, std::size_t) {
    rehearsal.act([](EditTarget& target) -> Expected<std::string> {
        const auto people = target.people();
        if (!people) return tl::unexpected<Error>(people.error());
        const PathBook book(target.scene());
        std::string text;
        for (const Person& person : *people) {
            text += in_quotes(person.name) + (person.user.empty() ? "" : " (" + person.user + ")") +
                    (person.editor ? ", editor" : ", viewer");
            if (!person.text.empty()) text += ": " + person.text;
            for (std::size_t i = 0; i < person.locked.size(); ++i) {
                text += (i == 0 ? "; holds " : ", ") + book.path(target.scene(), person.locked[i]);
            }
            text += "\n";
        }
        return text.empty() ? "nobody\n" : text;
    });
}

void begin_transaction(Rehearsal& rehearsal, const Arguments&, std::size_t) {
    rehearsal.begin();
}

void commit_transaction(Rehearsal& rehearsal, const Arguments&, std::size_t) {
    rehearsal.commit();
}

void roll_back(Rehearsal& rehearsal, const Arguments&, std::size_t) {
    rehearsal.rollback();
}

void wait_seconds(Rehearsal& rehearsal, const Arguments& arguments, std::size_t) {
    const double seconds = read_number(arguments[0]);
    if (!(seconds >= 0.0 && seconds <= LongestWait)) {
        throw ScriptError(arguments[0].column(), "'wait' takes 0 to 86400 seconds");
    }
    const auto duration = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
    rehearsal.act([duration](EditTarget& target) { return silent(target.wait(duration)); });
}

void close_scene(Rehearsal& rehearsal, const Arguments&, std::size_t) {
    rehearsal.lose_sight();
    rehearsal.act([](EditTarget& target) { return silent(target.close()); });
    rehearsal.quit();
}

void quit(Rehearsal& rehearsal, const Arguments&, std::size_t) {
    rehearsal.quit();
}

}  // namespace tessera::edit
