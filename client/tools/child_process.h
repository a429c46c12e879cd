#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tessera::tools {

// A program started with its output in files. Killed and waited for at the end of its scope.
class ChildProcess {
  public:
    // Standard output and error go to FOLDER/LABEL.{out,err}. Throws Error{NotFound} when it cannot start.
    ChildProcess(const std::filesystem::path& folder, const std::string& label,
                 const std::filesystem::path& program, const std::vector<std::string>& arguments);
    ~ChildProcess();
    ChildProcess(ChildProcess&& other) noexcept;
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    pid_t pid() const { return pid_; }
    void signal(int number) const;
    bool running();
    // The exit code (128 + n for signal n); nothing when it still runs at the limit.
    std::optional<int> wait(std::chrono::milliseconds limit);
    std::string out() const;
    std::string err() const;

  private:
    std::optional<int> reap(int options);

    pid_t pid_ = -1;
    std::optional<int> exit_code_;
    std::filesystem::path out_, err_;
};

// The folder of the program that runs.
std::filesystem::path program_folder();

// Two consecutive TCP ports of the loopback address that nobody uses right now.
std::string free_loopback_endpoint();

}  // namespace tessera::tools
