#include "master/scene/folder_lease.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>
#include <sstream>

#include "mediator/base/error.h"

namespace tessera::master {

namespace fs = std::filesystem;

namespace {

struct FolderOwner {
    std::string id, host;
    long pid = 0;
};

std::string host_name() {
    std::array<char, HOST_NAME_MAX + 1> name{};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::string new_content() {
    std::random_device device;
    std::ostringstream text;
    text << std::hex << device() << device() << device() << device() << std::dec << "\n"
         << host_name() << "\n"
         << ::getpid() << "\n";
    return text.str();
}

// Nothing: there is no such file. Throws Error{Io}.
std::optional<std::string> content_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        if (errno == ENOENT) return std::nullopt;
        throw Error(ErrorCode::Io, "cannot read '" + path.string() + "': " + std::strerror(errno));
    }
    return std::string(std::istreambuf_iterator<char>(file), {});
}

FolderOwner parsed(const std::string& content) {
    FolderOwner owner;
    std::istringstream(content) >> owner.id >> owner.host >> owner.pid;
    return owner;
}

std::string described(const FolderOwner& owner) {
    return "the master on " + owner.host + " (process " + std::to_string(owner.pid) + ")";
}

}  // namespace

FolderLease::FolderLease(fs::path folder, const Settings& settings)
    : folder_(std::move(folder)), path_(folder_ / "owner"), settings_(settings), content_(new_content()) {
    take();
    checked_at_ = SteadyClock().now();
    thread_ = std::jthread([this](const std::stop_token& stop) { refresh(stop); });
}

FolderLease::~FolderLease() {
    thread_.request_stop();
    thread_.join();
    check();
    std::error_code ignored;
    if (problem_.empty()) fs::remove(path_, ignored);
}

void FolderLease::take() {
    const auto cannot = [&](const std::string& why) {
        return Error(ErrorCode::Io, "cannot write '" + path_.string() + "': " + why +
                                        "; check the folder, its rights and the free space");
    };
    const fs::path unfinished = path_.string() + "." + parsed(content_).id + ".part";
    {
        std::ofstream file(unfinished, std::ios::binary);
        file << content_;
        if (!file.flush()) throw cannot(std::strerror(errno));
    }
    const std::optional<std::string> before = content_of(path_);
    const FolderOwner other = before ? parsed(*before) : FolderOwner{};
    const bool is_elsewhere = before && other.host != host_name();
    std::error_code error;
    if (is_elsewhere) {
        // Both times are of the file system's clock.
        const auto age = fs::last_write_time(unfinished, error) - fs::last_write_time(path_, error);
        if (!error && age < settings_.lifetime) {
            fs::remove(unfinished, error);
            throw Error(
                ErrorCode::Unavailable,
                described(other) + " uses the session folder '" + folder_.string() +
                    "': stop it, or choose another with --session; if it is gone, try again in " +
                    std::to_string(
                        std::chrono::duration_cast<std::chrono::seconds>(settings_.lifetime).count()) +
                    " s");
        }
    }
    fs::rename(unfinished, path_, error);
    if (error) throw cannot(error.message());
    // If it is not gone after all, it notices before this master reads the folder.
    if (is_elsewhere) std::this_thread::sleep_for(2 * settings_.recheck);
}

void FolderLease::check() {
    const std::scoped_lock lock(mutex_);
    if (is_lost_) return;
    try {
        const std::optional<std::string> content = content_of(path_);
        problem_.clear();
        if (!content) {
            problem_ = "the file '" + path_.string() + "' was removed: start the master again";
        } else if (*content != content_) {
            problem_ = described(parsed(*content)) + " has taken over the session folder '" +
                       folder_.string() + "': this master records nothing any more; stop one of them";
        }
        is_lost_ = !problem_.empty();
    } catch (const Error& error) {
        problem_ = error.what();
    }
    checked_at_ = SteadyClock().now();
}

std::string FolderLease::problem() {
    const auto is_due = [&] {
        const std::scoped_lock lock(mutex_);
        return SteadyClock().now() - checked_at_ >= settings_.recheck;
    };
    if (is_due()) check();
    const std::scoped_lock lock(mutex_);
    return problem_;
}

std::string FolderLease::lost_reason() {
    const std::scoped_lock lock(mutex_);
    return is_lost_ ? problem_ : std::string();
}

void FolderLease::refresh(const std::stop_token& stop) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    while (!stop.stop_requested()) {
        wake_.wait_for(lock, stop, settings_.refresh, [] { return false; });
        if (stop.stop_requested() || !problem().empty()) continue;
        ::utimensat(AT_FDCWD, path_.c_str(), nullptr, 0);  // now, by the file system's clock
    }
}

}  // namespace tessera::master
