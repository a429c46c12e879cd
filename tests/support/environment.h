#pragma once

#include <cstdlib>
#include <optional>
#include <string>

namespace tessera::test {

// For LD_LIBRARY_PATH: the folder before those that are in it.
inline std::string library_path(const std::string& folder) {
    const char* before = std::getenv("LD_LIBRARY_PATH");
    return before == nullptr ? folder : folder + ":" + before;
}

// Sets a variable of the environment, which child processes inherit, until the end of its scope.
class EnvironmentVariable {
  public:
    EnvironmentVariable(const std::string& name, const std::string& value) : name_(name) {
        if (const char* before = std::getenv(name.c_str())) before_ = before;
        ::setenv(name.c_str(), value.c_str(), 1);
    }
    ~EnvironmentVariable() {
        if (before_) {
            ::setenv(name_.c_str(), before_->c_str(), 1);
        } else {
            ::unsetenv(name_.c_str());
        }
    }
    EnvironmentVariable(const EnvironmentVariable&) = delete;
    EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;

  private:
    std::string name_;
    std::optional<std::string> before_;
};

}  // namespace tessera::test
