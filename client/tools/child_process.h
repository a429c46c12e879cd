#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tessera::tools {

// A child process with its output redirected to files. The destructor kills it and waits for it.
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
    // The exit code (128 + n for signal n); nothing if it still runs at the limit.
    std::optional<int> wait(std::chrono::milliseconds limit);
    std::string out() const;
    std::string err() const;

  private:
    std::optional<int> reap(int options);

    pid_t pid_ = -1;
    std::optional<int> exit_code_;
    std::filesystem::path out_, err_;
};

// The folder of the running executable.
std::filesystem::path program_folder();

// An endpoint with two consecutive unused TCP ports on the loopback address.
std::string free_loopback_endpoint();

}  // namespace tessera::tools
