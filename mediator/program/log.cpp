#include "mediator/program/log.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "mediator/base/error.h"
#include "mediator/program/command_line.h"
#include "mediator/program/crash_report.h"

namespace tessera::cli {

namespace {

// "text [unit=7 view=3 version=5.12 node=a]"
std::string as_text(std::string_view text, const LogSubject& about) {
    std::string subject;
    const auto add = [&](const char* name, const std::string& value) {
        subject += (subject.empty() ? " [" : " ") + std::string(name) + "=" + value;
    };
    if (about.session) add("session", std::to_string(about.session.value));
    if (about.view) add("view", std::to_string(about.view.value));
    if (about.unit) add("unit", std::to_string(about.unit.value));
    if (about.version)
        add("version", std::to_string(about.version->epoch) + "." + std::to_string(about.version->number));
    if (!about.node.empty() && text.find("node " + about.node) == text.npos) add("node", about.node);
    return std::string(text) + (subject.empty() ? "" : subject + "]");
}

// The same as the members of a JSON object, without braces: the logger's pattern has those of every line.
std::string as_json(std::string_view text, const LogSubject& about) {
    using Json = nlohmann::ordered_json;
    Json line{{"text", text}};
    if (about.session) line["session"] = about.session.value;
    if (about.view) line["view"] = about.view.value;
    if (about.unit) line["unit"] = about.unit.value;
    if (about.version) line["version"] = {{"epoch", about.version->epoch}, {"number", about.version->number}};
    if (!about.node.empty()) line["node"] = about.node;
    const std::string object = line.dump(-1, ' ', false, Json::error_handler_t::replace);
    return object.substr(1, object.size() - 2);
}

constexpr const char* TextPattern = "%Y-%m-%d %H:%M:%S.%e %n %^%l%$ %v";
constexpr const char* JsonPattern = R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","program":"%n","level":"%l",%v})";

}  // namespace

struct Log::Implementation {
    spdlog::logger logger;
    bool is_json;

    void write(spdlog::level::level_enum level, std::string_view text, const LogSubject& about) {
        if (logger.should_log(level))
            logger.log(level, "{}", is_json ? as_json(text, about) : as_text(text, about));
    }
};

namespace {

spdlog::sink_ptr sink(const std::string& file) {
    if (file.empty()) return std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
    try {
        return std::make_shared<spdlog::sinks::basic_file_sink_mt>(file);
    } catch (const spdlog::spdlog_ex& error) {
        throw Error(ErrorCode::Io, "cannot write the log file '" + file + "': " + error.what());
    }
}

class CrashReportSink : public spdlog::sinks::base_sink<std::mutex> {
    void sink_it_(const spdlog::details::log_msg& message) override {
        spdlog::memory_buf_t line;
        formatter_->format(message, line);
        remember_for_crash_report({line.data(), line.size()});
    }
    void flush_() override {}
};

}  // namespace

void add_log_options(CommandLine& line, LogSettings& settings) {
    line.choice("--log-level", "log verbosity", settings.level, {"debug", "info", "warning", "error", "off"});
    line.option("--log-file", "write the log to this file instead of standard error", settings.file);
    line.choice("--log-format", "lines of text, or a JSON object per line", settings.format,
                {"text", "json"});
}

Log::Log(const LogSettings& settings)
    : implementation_(new Implementation{
          spdlog::logger(settings.program, {sink(settings.file), std::make_shared<CrashReportSink>()}),
          settings.format == "json"}) {
    implementation_->logger.set_level(spdlog::level::from_str(settings.level));
    implementation_->logger.flush_on(spdlog::level::info);
    implementation_->logger.set_pattern(implementation_->is_json ? JsonPattern : TextPattern);
}

Log::~Log() = default;
Log::Log(Log&&) noexcept = default;

void Log::debug(std::string_view text, const LogSubject& about) const {
    implementation_->write(spdlog::level::debug, text, about);
}
void Log::info(std::string_view text, const LogSubject& about) const {
    implementation_->write(spdlog::level::info, text, about);
}
void Log::warning(std::string_view text, const LogSubject& about) const {
    implementation_->write(spdlog::level::warn, text, about);
}
void Log::error(std::string_view text, const LogSubject& about) const {
    implementation_->write(spdlog::level::err, text, about);
}

}  // namespace tessera::cli
