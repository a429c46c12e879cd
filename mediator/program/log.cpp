#include "mediator/program/log.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "mediator/base/error.h"
#include "mediator/program/crash_report.h"

namespace tessera::cli {

struct Log::Implementation {
    spdlog::logger logger;
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

std::vector<std::string> log_levels() {
    return {"debug", "info", "warning", "error", "off"};
}

Log::Log(const LogSettings& settings)
    : implementation_(new Implementation{
          spdlog::logger(settings.program, {sink(settings.file), std::make_shared<CrashReportSink>()})}) {
    implementation_->logger.set_level(spdlog::level::from_str(settings.level));
    implementation_->logger.flush_on(spdlog::level::info);
    implementation_->logger.set_pattern("%Y-%m-%d %H:%M:%S.%e %n %^%l%$ %v");
}

Log::~Log() = default;
Log::Log(Log&&) noexcept = default;

void Log::debug(std::string_view text) const {
    implementation_->logger.debug("{}", text);
}
void Log::info(std::string_view text) const {
    implementation_->logger.info("{}", text);
}
void Log::warning(std::string_view text) const {
    implementation_->logger.warn("{}", text);
}
void Log::error(std::string_view text) const {
    implementation_->logger.error("{}", text);
}

}  // namespace tessera::cli
