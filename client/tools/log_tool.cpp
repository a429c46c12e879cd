#include "client/tools/log_tool.h"

#include <ctime>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "master/scene/session_log.h"
#include "master/scene/transaction_text.h"

namespace tessera::tools {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* LogName = "log";
constexpr std::size_t MaxText = 200;

struct LogOptions {
    std::string folder, object;
    bool json = false;
    std::uint64_t last = 0;
};

// "2026-11-21 16:59:21.123" in local time.
std::string time_text(std::int64_t nanoseconds) {
    const std::time_t whole = nanoseconds / 1'000'000'000;
    std::tm parts{};
    localtime_r(&whole, &parts);
    char text[40], with_milliseconds[48];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &parts);
    std::snprintf(with_milliseconds, sizeof with_milliseconds, "%s.%03d", text,
                  static_cast<int>(nanoseconds / 1'000'000 % 1000));
    return with_milliseconds;
}

Json as_json(const master::LoggedTransaction& entry) {
    Json objects = Json::array();
    for (const ObjectId id : entry.objects) objects.push_back(id.value);
    return {{"transaction", entry.number}, {"time_ns", entry.time}, {"user", entry.user},
            {"name", entry.name},          {"edits", entry.edits},  {"undoes", entry.undoes},
            {"text", entry.text},          {"objects", objects}};
}

void print(const master::LoggedTransaction& entry) {
    std::cout << entry.number << "  " << time_text(entry.time) << "  " << master::shown(entry.user, MaxText)
              << "  " << master::shown(entry.name, MaxText) << "  " << master::shown(entry.text, MaxText);
    if (entry.edits > 1) std::cout << " (" << entry.edits << " edits)";
    std::cout << "\n";
}

int run(const LogOptions& options) {
    master::SessionLog log = master::read_session_log(options.folder, options.object);
    auto& list = log.transactions;
    if (options.last != 0 && list.size() > options.last)
        list.erase(list.begin(), list.end() - static_cast<std::ptrdiff_t>(options.last));
    if (options.json) {
        Json all = Json::array();
        for (const master::LoggedTransaction& entry : list) all.push_back(as_json(entry));
        std::cout << all.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
    } else {
        for (const master::LoggedTransaction& entry : list) print(entry);
    }
    for (const std::string& note : log.notes) std::cerr << "tessera log: " << note << "\n";
    return 0;
}

}  // namespace

Command log_command(cli::CommandLine& program) {
    const auto options = std::make_shared<LogOptions>();
    cli::CommandLine& line = program.command(
        LogName, "List the transactions of a recorded session: number, time, key, client name, description.");
    line.positional("FOLDER", "session folder, as given to tessera-master --session", options->folder);
    line.option("--object",
                "only transactions that changed this object: its path, as materials/red, or its id",
                options->object);
    line.option("--last", "only the latest N transactions", options->last);
    line.flag("--json", "print one JSON array", options->json);
    line.examples({"tessera log room.session", "tessera log room.session --object materials/red --last 10"});
    return {LogName, [options](std::string_view) {
                try {
                    return run(*options);
                } catch (const Error& error) {
                    return report_error(LogName, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
