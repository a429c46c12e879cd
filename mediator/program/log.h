#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::cli {

struct LogSettings {
    std::string program;
    std::string level = "info";  // one of log_levels()
    std::string file{};          // "" = standard error
};

std::vector<std::string> log_levels();

// The log of a program; libraries report by return value or callback. Thread-safe.
class Log {
  public:
    explicit Log(const LogSettings& settings);  // throws Error{Io} when the file cannot be written
    ~Log();
    Log(Log&&) noexcept;

    void debug(std::string_view text) const;
    void info(std::string_view text) const;
    void warning(std::string_view text) const;
    void error(std::string_view text) const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace tessera::cli
