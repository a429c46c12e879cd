#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/base/log_subject.h"

namespace tessera::cli {

struct LogSettings {
    std::string program;
    std::string level = "info";   // or debug, warning, error, off
    std::string file{};           // "" = standard error
    std::string format = "text";  // or json: an object per line
};

class CommandLine;

// --log-level, --log-file and --log-format.
void add_log_options(CommandLine& line, LogSettings& settings);

// The log of a program; libraries report by return value or callback. Thread-safe.
class Log {
  public:
    explicit Log(const LogSettings& settings);  // throws Error{Io} when the file cannot be written
    ~Log();
    Log(Log&&) noexcept;

    void debug(std::string_view text, const LogSubject& about = {}) const;
    void info(std::string_view text, const LogSubject& about = {}) const;
    void warning(std::string_view text, const LogSubject& about = {}) const;
    void error(std::string_view text, const LogSubject& about = {}) const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace tessera::cli
