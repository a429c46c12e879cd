#include "mediator/program/crash_report.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <exception>
#include <typeinfo>

#include "mediator/program/command_line.h"

// What follows runs in a process that is broken: it allocates nothing, takes no lock, and calls only what POSIX allows in
// signal handlers.
namespace tessera::cli {

namespace {

constexpr std::size_t LineCount = 64, MaxLine = 400;
constexpr const char* StackTool = "/usr/bin/eu-stack";

struct Line {
    std::array<char, MaxLine> text;
    std::size_t length = 0;
};

struct State {
    std::array<Line, LineCount> lines;
    std::atomic<std::size_t> line_count = 0;
    std::array<char, 4096> path{};
    std::array<char, 256> build{};
    std::array<char, 512> exception{};
    std::atomic_flag is_reporting = ATOMIC_FLAG_INIT;
};
State state;

template <std::size_t Size>
void copy(std::array<char, Size>& to, std::string_view text) {
    const std::size_t length = std::min(text.size(), Size - 1);
    std::memcpy(to.data(), text.data(), length);
    to[length] = '\0';
}

void write_text(int file, std::string_view text) {
    while (!text.empty()) {
        const ssize_t written = ::write(file, text.data(), text.size());
        if (written <= 0) return;
        text.remove_prefix(static_cast<std::size_t>(written));
    }
}

class Digits {
  public:
    explicit Digits(unsigned long value) {
        do digits_[--first_] = static_cast<char>('0' + value % 10);
        while ((value /= 10) > 0);
    }
    const char* text() const { return digits_.data() + first_; }

  private:
    std::array<char, 24> digits_{};
    std::size_t first_ = 23;
};

void write_lines(int file) {
    const std::size_t count = state.line_count;
    write_text(file, "\nthe latest lines of the log:\n");
    for (std::size_t i = count - std::min(count, LineCount); i < count; ++i) {
        const Line& line = state.lines[i % LineCount];
        write_text(file, {line.text.data(), std::min(line.length, MaxLine)});
    }
}

// By another process, which reads this one like a debugger.
void write_stacks(int file) {
    write_text(file, "\nthe stacks of all threads:\n");
    if (::access(StackTool, X_OK) != 0) return write_text(file, "not known: install elfutils\n");
    (void)::prctl(PR_SET_PTRACER, PR_SET_PTRACER_ANY, 0, 0, 0);
    const Digits process(static_cast<unsigned long>(::getpid()));
    const pid_t child = ::_Fork();
    if (child == 0) {
        (void)::dup2(file, STDOUT_FILENO);
        (void)::dup2(file, STDERR_FILENO);
        std::array<char*, 4> words{const_cast<char*>(StackTool), const_cast<char*>("-p"),
                                   const_cast<char*>(process.text()), nullptr};
        ::execv(StackTool, words.data());
        ::_exit(127);
    }
    constexpr int Patience = 300;  // times 0.1 s
    for (int i = 0; child > 0 && ::waitpid(child, nullptr, WNOHANG) == 0; ++i) {
        if (i == Patience) (void)::kill(child, SIGKILL);
        const timespec pause{.tv_sec = 0, .tv_nsec = 100'000'000};
        (void)::nanosleep(&pause, nullptr);
    }
}

void write_report(int file, int signal) {
    write_text(file, state.build.data());
    write_text(file, "\nprocess ");
    write_text(file, Digits(static_cast<unsigned long>(::getpid())).text());
    write_text(file, " died of signal ");
    write_text(file, Digits(static_cast<unsigned long>(signal)).text());
    const char* const name = ::sigabbrev_np(signal);
    write_text(file, " (SIG");
    write_text(file, name == nullptr ? "?" : name);
    write_text(file, ") in thread ");
    write_text(file, Digits(static_cast<unsigned long>(::gettid())).text());
    write_text(file, ", seconds since 1970: ");
    write_text(file, Digits(static_cast<unsigned long>(::time(nullptr))).text());
    write_text(file, "\n");
    if (state.exception[0] != '\0') {
        write_text(file, "exception that was not caught: ");
        write_text(file, state.exception.data());
        write_text(file, "\n");
    }
    write_lines(file);
    write_stacks(file);
}

void on_signal(int signal) {
    if (state.is_reporting.test_and_set()) {
        for (;;) ::pause();  // another thread is at it
    }
    // The default action follows when this handler returns, or at once if the report fails, too.
    struct sigaction usual {};
    usual.sa_handler = SIG_DFL;
    for (const int each : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT})
        (void)::sigaction(each, &usual, nullptr);
    const int file = ::open(state.path.data(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0600);
    write_text(STDERR_FILENO, state.build.data());
    write_text(STDERR_FILENO, " has crashed, of a bug; please report it with ");
    write_text(STDERR_FILENO, file < 0 ? "what follows" : state.path.data());
    write_text(STDERR_FILENO, "\n");
    write_report(file < 0 ? STDERR_FILENO : file, signal);
    if (file >= 0) (void)::close(file);
    (void)::raise(signal);
}

[[noreturn]] void on_terminate() {
    try {
        if (std::current_exception()) std::rethrow_exception(std::current_exception());
    } catch (const std::exception& error) {
        copy(state.exception, error.what());
    } catch (...) {
        copy(state.exception, "of an unknown type");
    }
    std::abort();
}

}  // namespace

void report_crashes(const LogSettings& log, const std::filesystem::path& folder) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return;
#endif
    std::filesystem::path place = folder;
    if (!log.file.empty()) place = std::filesystem::absolute(log.file).parent_path();
    if (place.empty()) place = std::filesystem::temp_directory_path();
    place = std::filesystem::absolute(place);
    copy(state.path, (place / (log.program + "-crash-" + std::to_string(::getpid()) + ".txt")).string());
    copy(state.build, log.program + " " + version());
    std::set_terminate(on_terminate);
    // A stack of its own, for overflows of the main thread's.
    static std::array<char, 1 << 16> stack;
    const stack_t other{.ss_sp = stack.data(), .ss_flags = 0, .ss_size = stack.size()};
    (void)::sigaltstack(&other, nullptr);
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_ONSTACK;
    for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT})
        (void)::sigaction(signal, &action, nullptr);
}

void remember_for_crash_report(std::string_view text) {
    const std::size_t count = state.line_count;
    Line& line = state.lines[count % LineCount];
    line.length = std::min(text.size(), MaxLine);
    std::memcpy(line.text.data(), text.data(), line.length);
    if (line.length < text.size()) line.text.back() = '\n';
    state.line_count = count + 1;
}

}  // namespace tessera::cli
