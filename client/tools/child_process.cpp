#include "client/tools/child_process.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include "mediator/base/error.h"

extern char** environ;

namespace tessera::tools {

namespace {

std::string contents(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

// Binds a port for a moment to see whether it is free.
bool is_free(int port) {
    const int socket_fd = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    const int one = 1;
    setsockopt(socket_fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
    const bool bound = bind(socket_fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    close(socket_fd);
    return bound;
}

}  // namespace

ChildProcess::ChildProcess(const std::filesystem::path& folder, const std::string& label,
                           const std::filesystem::path& program, const std::vector<std::string>& arguments)
    : out_(folder / (label + ".out")), err_(folder / (label + ".err")) {
    const std::string path = program.string();
    std::vector<char*> argv{const_cast<char*>(path.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, 1, out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&files, 2, err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int error = posix_spawnp(&pid_, path.c_str(), &files, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) throw Error(ErrorCode::NotFound, "cannot start '" + path + "': is it installed?");
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      exit_code_(other.exit_code_),
      out_(std::move(other.out_)),
      err_(std::move(other.err_)) {}

ChildProcess::~ChildProcess() {
    if (pid_ <= 0 || exit_code_) return;
    kill(pid_, SIGKILL);
    reap(0);
}

void ChildProcess::signal(int number) const {
    if (!exit_code_) kill(pid_, number);
}

std::optional<int> ChildProcess::reap(int options) {
    if (exit_code_) return exit_code_;
    int status = 0;
    if (waitpid(pid_, &status, options) != pid_) return std::nullopt;
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return exit_code_;
}

bool ChildProcess::running() {
    return !reap(WNOHANG);
}

std::optional<int> ChildProcess::wait(std::chrono::milliseconds limit) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (running()) {
        if (std::chrono::steady_clock::now() > deadline) return std::nullopt;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return exit_code_;
}

std::string ChildProcess::out() const {
    return contents(out_);
}
std::string ChildProcess::err() const {
    return contents(err_);
}

std::filesystem::path program_folder() {
    return std::filesystem::canonical("/proc/self/exe").parent_path();
}

std::string free_loopback_endpoint() {
    // Below the ephemeral range, spread by process so that several at the same time do not meet.
    int port = 20000 + 2 * (getpid() % 5000);
    while (!is_free(port) || !is_free(port + 1)) port = port >= 31990 ? 20000 : port + 2;
    return "tcp://127.0.0.1:" + std::to_string(port);
}

}  // namespace tessera::tools
