#include "client/import/limited_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>

namespace tessera::import {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool HasShadowMemory = true;  // of terabytes of address space
#else
constexpr bool HasShadowMemory = false;
#endif

// The stream consists of pieces: their size, then their bytes. These sizes end it.
constexpr std::uint64_t EndOfStream = 0, ErrorFollows = ~std::uint64_t{0};
constexpr std::size_t LongestMessage = 4096;
constexpr int PipeEnd = 3;  // in the child

std::span<const std::byte> bytes_of(const std::uint64_t& value) {
    return std::as_bytes(std::span(&value, 1));
}

// In the child.

void write_all(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(PipeEnd, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) ::_exit(1);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

void write_piece(std::span<const std::byte> bytes) {
    if (bytes.empty()) return;
    write_all(bytes_of(bytes.size()));
    write_all(bytes);
}

void write_error(ErrorCode code, const std::string& message) {
    const std::string text = message.substr(0, LongestMessage);
    write_all(bytes_of(ErrorFollows));
    write_all(bytes_of(static_cast<std::uint64_t>(code)));
    write_all(bytes_of(text.size()));
    write_all(std::as_bytes(std::span(text)));
}

std::uint64_t address_space() {
    unsigned long pages = 0;
    if (std::FILE* file = std::fopen("/proc/self/statm", "re")) {
        if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
        std::fclose(file);
    }
    return std::uint64_t{pages} * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void lower_limit(__rlimit_resource resource, std::uint64_t value) {
    rlimit limit{};
    ::getrlimit(resource, &limit);
    limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, value);
    ::setrlimit(resource, &limit);
}

void confine(const ProcessLimits& limits, pid_t parent, int pipe) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);
    for (int number = 1; number < NSIG; ++number) std::signal(number, SIG_DFL);
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    lower_limit(RLIMIT_CORE, 0);
    lower_limit(RLIMIT_CPU, static_cast<std::uint64_t>(limits.processor_time.count()));
    if (!HasShadowMemory) lower_limit(RLIMIT_AS, address_space() + limits.memory);
    if (pipe != PipeEnd && ::dup2(pipe, PipeEnd) < 0) ::_exit(1);
    ::close_range(PipeEnd + 1, ~0u, 0);
}

[[noreturn]] void be_the_child(const std::function<void(const ByteSink&)>& produce) {
    try {
        produce(write_piece);
        write_all(bytes_of(EndOfStream));
    } catch (const Error& error) {
        write_error(error.code(), error.what());
    } catch (const std::bad_alloc&) {
        write_error(ErrorCode::OutOfMemory, "");
    } catch (const std::exception& error) {
        write_error(ErrorCode::InvalidInput,
                    "it cannot be read (" + std::string(error.what()) + "): export it again");
    }
    ::_exit(0);
}

// In the parent.

class Child {
  public:
    Child(const ProcessLimits& limits, const std::function<void(const ByteSink&)>& produce)
        : limits_(limits), deadline_(std::chrono::steady_clock::now() + limits.wall_time) {
        int ends[2];
        if (::pipe2(ends, O_CLOEXEC) != 0) reject_start();
        const pid_t parent = ::getpid();
        // So that no handler of this process runs in the child.
        sigset_t all, before;
        sigfillset(&all);
        ::pthread_sigmask(SIG_SETMASK, &all, &before);
        process_ = ::fork();
        const int cause = errno;
        if (process_ == 0) {
            confine(limits, parent, ends[1]);
            be_the_child(produce);
        }
        ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
        ::close(ends[1]);
        pipe_ = ends[0];
        errno = cause;
        if (process_ < 0) {
            ::close(pipe_);
            reject_start();
        }
    }
    ~Child() {
        ::close(pipe_);
        end();
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    void read(std::span<std::byte> bytes) {
        while (!bytes.empty()) {
            if (piece_left_ == 0) piece_left_ = read_size();
            if (piece_left_ == EndOfStream)
                throw Error(ErrorCode::Internal, "its reader ended too early: export it again");
            const std::size_t count = std::min<std::uint64_t>(piece_left_, bytes.size());
            read_raw(bytes.first(count));
            piece_left_ -= count;
            bytes = bytes.subspan(count);
        }
    }
    void read_end() {
        if (piece_left_ != 0 || read_size() != EndOfStream)
            throw Error(ErrorCode::Internal, "its reader sent too much: export it again");
    }

  private:
    [[noreturn]] static void reject_start() {
        throw Error(ErrorCode::Unavailable, std::string("no process can be started to read it (") +
                                                std::strerror(errno) + "): free memory or processes");
    }

    std::uint64_t read_number() {
        std::uint64_t value = 0;
        read_raw(std::as_writable_bytes(std::span(&value, 1)));
        return value;
    }
    // Of the next piece; throws what the child threw.
    std::uint64_t read_size() {
        const std::uint64_t size = read_number();
        if (size != ErrorFollows) return size;
        const std::uint64_t code = read_number();
        std::string text(std::min<std::uint64_t>(read_number(), LongestMessage), '\0');
        read_raw(std::as_writable_bytes(std::span(text)));
        if (code == static_cast<std::uint64_t>(ErrorCode::OutOfMemory) && text.empty()) reject_memory();
        throw Error(static_cast<ErrorCode>(std::min(code, static_cast<std::uint64_t>(ErrorCode::Internal))),
                    text);
    }
    void read_raw(std::span<std::byte> bytes) {
        while (!bytes.empty()) {
            wait_until_readable();
            const ssize_t count = ::read(pipe_, bytes.data(), bytes.size());
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) reject_end(end());
            bytes = bytes.subspan(static_cast<std::size_t>(count));
        }
    }
    void wait_until_readable() {
        for (;;) {
            using std::chrono::milliseconds;
            const auto left = std::chrono::ceil<milliseconds>(deadline_ - std::chrono::steady_clock::now());
            if (left <= milliseconds(0)) reject_time(limits_.wall_time);
            pollfd ready{.fd = pipe_, .events = POLLIN, .revents = 0};
            const int count =
                ::poll(&ready, 1, static_cast<int>(std::min<std::int64_t>(left.count(), 60'000)));
            if (count > 0) return;
        }
    }

    // Kills the child if it still runs and returns its status. A signal of its own is not overwritten: its files are
    // closed after its status is set.
    int end() {
        if (process_ <= 0) return 0;
        ::kill(process_, SIGKILL);
        int status = 0;
        while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
        process_ = 0;
        return status;
    }
    [[noreturn]] void reject_end(int status) const {
        const int number = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
        if (number == SIGXCPU) reject_time(limits_.processor_time);
        if (number == SIGINT || number == SIGTERM || number == SIGHUP || number == SIGQUIT)
            throw Error(ErrorCode::Unavailable, "reading it was interrupted: start again");
        if (number == SIGKILL) reject_memory();
        throw Error(ErrorCode::InvalidInput,
                    "its reader crashed" +
                        (number != 0 ? " (" + std::string(strsignal(number)) + ")" : std::string()) +
                        ": it is damaged, export it again");
    }
    [[noreturn]] static void reject_time(std::chrono::seconds time) {
        throw Error(ErrorCode::InvalidInput, "reading it takes more than " + std::to_string(time.count()) +
                                                 " s: it is damaged, or split it");
    }
    [[noreturn]] void reject_memory() const {
        throw Error(ErrorCode::OutOfMemory,
                    "reading it takes more than " + std::to_string(limits_.memory >> 20) +
                        " MiB, or all memory of this machine: it is damaged, or split it");
    }

    ProcessLimits limits_;
    std::chrono::steady_clock::time_point deadline_;
    pid_t process_ = 0;
    int pipe_ = -1;
    std::uint64_t piece_left_ = 0;
};

}  // namespace

void run_limited(const ProcessLimits& limits, const std::function<void(const ByteSink&)>& produce,
                 const std::function<void(const ByteSource&)>& consume) {
    Child child(limits, produce);
    consume([&child](std::span<std::byte> bytes) { child.read(bytes); });
    child.read_end();
}

}  // namespace tessera::import
