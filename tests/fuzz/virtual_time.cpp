#include "tests/fuzz/virtual_time.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <list>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

// Replaces functions of the C library in the program that this object is linked to. They call the kernel, and not the
// functions that they replace, since those may be called before the dynamic linker could look them up.

namespace tessera::test {
namespace {

constexpr std::int64_t Second = 1'000'000'000;

std::int64_t nanoseconds(const timespec& time) {
    return time.tv_sec * Second + time.tv_nsec;
}

timespec time_of(std::int64_t nanoseconds) {
    return {.tv_sec = nanoseconds / Second, .tv_nsec = nanoseconds % Second};
}

std::int64_t read_clock(clockid_t clock) {
    timespec now{};
    ::syscall(SYS_clock_gettime, clock, &now);
    return nanoseconds(now);
}

void sleep_really(std::int64_t duration) {
    const timespec time = time_of(duration);
    ::syscall(SYS_clock_nanosleep, CLOCK_MONOTONIC, 0, &time, nullptr);
}

// The threads of this process but the one that asks.
class OtherThreads {
  public:
    ~OtherThreads() { close_all(); }

    // All wait for something else than the disk.
    bool sleep() {
        if (!used_no_time()) return false;  // cheaper than to ask for their states
        if (count() != stats_.size()) find();
        for (const auto& [thread, stat] : stats_) {
            if (const char state = state_of(stat); state != 'S') {
                if (state == 0) find();
                return false;
            }
        }
        // One may have woken another that was seen asleep, and fallen asleep itself.
        return used_no_time() && count() == stats_.size();
    }

  private:
    // Since the last call. The two clocks are not read at the same moment.
    bool used_no_time() {
        constexpr std::int64_t ReadingClocks = 2'000;
        const std::int64_t used = read_clock(CLOCK_PROCESS_CPUTIME_ID) - read_clock(CLOCK_THREAD_CPUTIME_ID);
        return used - std::exchange(used_, used) < ReadingClocks;
    }
    static std::size_t count() {
        struct stat folder {};
        constexpr std::size_t OfEveryFolder = 2, Caller = 1;
        return ::stat("/proc/self/task", &folder) == 0 ? folder.st_nlink - OfEveryFolder - Caller : 0;
    }
    // 'R', 'S', 'D' ...; 0: it has ended.
    static char state_of(int stat) {
        char text[256];
        const ssize_t size = ::pread(stat, text, sizeof text, 0);
        if (size <= 0) return 0;
        const std::string_view all(text, static_cast<std::size_t>(size));
        const std::size_t name_end = all.rfind(')');
        return name_end + 2 < all.size() ? all[name_end + 2] : 0;
    }
    void find() {
        close_all();
        const auto self = std::to_string(::syscall(SYS_gettid));
        std::error_code error;
        for (std::filesystem::directory_iterator it("/proc/self/task", error), end; it != end;
             it.increment(error)) {
            if (it->path().filename() == self) continue;
            if (const int stat = ::open((it->path() / "stat").c_str(), O_RDONLY | O_CLOEXEC); stat >= 0)
                stats_[it->path().filename()] = stat;
        }
    }
    void close_all() {
        for (const auto& [thread, stat] : stats_) ::close(stat);
        stats_.clear();
    }

    std::map<std::string, int> stats_;  // open files, by thread
    std::int64_t used_ = 0;
};

std::atomic<std::int64_t> now = 0;  // 0: time is real
std::int64_t begin = 0;

struct Wait {
    pthread_cond_t* condition;
    std::int64_t end;
};
// Never destroyed: threads may wait until the process ends.
std::mutex& waits_mutex = *new std::mutex;  // protects the waits
std::list<Wait>& waits = *new std::list<Wait>;
std::atomic<std::uint64_t> begun_waits = 0;

// A wait that has ended is woken again and again until its thread has noticed, since the thread may have been about to
// sleep.
void jump(std::uint64_t begun) {
    const std::scoped_lock lock(waits_mutex);
    if (waits.empty() || begun_waits != begun) return;
    const auto first = std::ranges::min_element(waits, {}, &Wait::end);
    if (first->end > now) now = first->end;
    for (const Wait& wait : waits) {
        if (wait.end <= now) ::pthread_cond_broadcast(wait.condition);
    }
}

void keep_time() {
    ::prctl(PR_SET_TIMERSLACK, 1);
    constexpr std::int64_t Interval = 20'000, Rest = 60'000;
    OtherThreads others;
    bool slept = false;
    while (true) {
        sleep_really(slept ? Interval : Rest);
        const std::uint64_t begun = begun_waits;
        slept = others.sleep();
        if (slept) jump(begun);
    }
}

int wait(pthread_cond_t* condition, pthread_mutex_t* mutex, std::int64_t end) {
    if (end <= now) return ETIMEDOUT;
    ++begun_waits;
    std::unique_lock lock(waits_mutex);
    const auto own = waits.insert(waits.end(), {condition, end});
    lock.unlock();
    ::pthread_cond_wait(condition, mutex);
    lock.lock();
    waits.erase(own);
    return now >= end ? ETIMEDOUT : 0;
}

int sleep_until(std::int64_t end) {
    std::mutex mutex;
    pthread_cond_t condition = PTHREAD_COND_INITIALIZER;
    const std::scoped_lock lock(mutex);
    while (now < end) wait(&condition, mutex.native_handle(), end);
    return 0;
}

}  // namespace

void begin_virtual_time() {
    if (now != 0) return;
    begin = read_clock(CLOCK_MONOTONIC);
    now = begin;
    std::thread(keep_time).detach();
}

std::chrono::nanoseconds virtual_time() {
    return std::chrono::nanoseconds(now - begin);
}

}  // namespace tessera::test

using namespace tessera::test;  // NOLINT: names of this file

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
    if (clock != CLOCK_MONOTONIC || now == 0) {
        // That of the C library reads some clocks without a call of the kernel.
        static const auto real =
            reinterpret_cast<int (*)(clockid_t, timespec*)>(::dlsym(RTLD_NEXT, "clock_gettime"));
        return real(clock, time);
    }
    *time = time_of(now);
    return 0;
}

int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                           const timespec* end) {
    if (clock == CLOCK_MONOTONIC && now != 0) return wait(condition, mutex, nanoseconds(*end));
    // That of the C library, for a wait by a real clock.
    timespec real{};
    ::clock_gettime(CLOCK_REALTIME, &real);
    timespec from{};
    ::clock_gettime(clock, &from);
    real = time_of(nanoseconds(real) + nanoseconds(*end) - nanoseconds(from));
    return ::pthread_cond_timedwait(condition, mutex, &real);
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* rest) {
    if (clock != CLOCK_MONOTONIC || now == 0) {
        const auto result = ::syscall(SYS_clock_nanosleep, clock, flags, time, rest);
        return result == 0 ? 0 : errno;
    }
    return sleep_until((flags & TIMER_ABSTIME) != 0 ? nanoseconds(*time) : now + nanoseconds(*time));
}

int nanosleep(const timespec* time, timespec*) {
    return now == 0 ? static_cast<int>(::syscall(SYS_nanosleep, time, nullptr))
                    : sleep_until(now + nanoseconds(*time));
}
}
