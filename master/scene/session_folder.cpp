#include "master/scene/session_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>

namespace tessera::master {

namespace fs = std::filesystem;

namespace {

constexpr const char* JournalPrefix = "journal-";
constexpr const char* CheckpointPrefix = "checkpoint-";

Error cannot_use(const fs::path& path, const std::string& reason) {
    return Error(ErrorCode::Io, "cannot use the session folder '" + path.string() + "': " + reason +
                                    "; choose another with --session");
}

fs::path numbered(const fs::path& folder, const char* prefix, std::uint64_t number) {
    char text[32];
    std::snprintf(text, sizeof text, "%s%06llu", prefix, static_cast<unsigned long long>(number));
    return folder / text;
}

std::optional<std::uint64_t> number_in(const std::string& name, const std::string& prefix) {
    if (!name.starts_with(prefix)) return std::nullopt;
    const std::string digits = name.substr(prefix.size());
    if (digits.size() < 6 || digits.size() > 18 || digits.find_first_not_of("0123456789") != digits.npos)
        return std::nullopt;
    return std::stoull(digits);
}

}  // namespace

fs::path journal_path(const fs::path& folder, std::uint64_t number) {
    return numbered(folder, JournalPrefix, number);
}

fs::path checkpoint_path(const fs::path& folder, std::uint64_t number) {
    return numbered(folder, CheckpointPrefix, number);
}

fs::path blobs_path(const fs::path& folder) {
    return folder / "blobs";
}

SessionFiles session_files(const fs::path& folder) {
    SessionFiles files;
    std::error_code error;
    for (fs::directory_iterator place(folder, error), end; !error && place != end; place.increment(error)) {
        const std::string name = place->path().filename().string();
        if (const auto number = number_in(name, JournalPrefix)) files.journals.push_back(*number);
        if (const auto number = number_in(name, CheckpointPrefix)) files.checkpoints.push_back(*number);
    }
    if (error) {
        throw Error(ErrorCode::Io,
                    "cannot read the session folder '" + folder.string() + "': " + error.message());
    }
    std::sort(files.journals.begin(), files.journals.end());
    std::sort(files.checkpoints.begin(), files.checkpoints.end());
    return files;
}

SessionFolder::SessionFolder(fs::path path) : path_(std::move(path)) {
    std::error_code error;
    fs::create_directories(blobs_path(path_), error);
    if (error) throw cannot_use(path_, error.message());
    lock_ =
        std::make_shared<FileHandle>(::open((path_ / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
    if (lock_->descriptor() < 0) throw cannot_use(path_, std::strerror(errno));
    if (::flock(lock_->descriptor(), LOCK_EX | LOCK_NB) != 0) {
        throw Error(ErrorCode::Unavailable, "another master uses the session folder '" + path_.string() +
                                                "': stop it, or choose another with --session");
    }
    lease_ = std::make_shared<FolderLease>(path_);
    remove_leftovers(path_);
}

void remove_leftovers(const fs::path& folder) {
    constexpr auto Kept = std::chrono::days(7);
    const auto now = fs::file_time_type::clock::now();
    for (const fs::path& part : {folder, blobs_path(folder), folder / "jobs"}) {
        std::error_code error;
        std::vector<fs::path> leftovers;
        for (fs::directory_iterator place(part, error), end; !error && place != end; place.increment(error)) {
            const std::string name = place->path().filename().string();
            std::error_code ignored;
            const auto age = now - fs::last_write_time(place->path(), ignored);
            const bool was_damaged = name.ends_with(".damaged") || name.find(".tail-") != name.npos;
            if (name.ends_with(".part") || (was_damaged && !ignored && age > Kept))
                leftovers.push_back(place->path());
        }
        for (const fs::path& leftover : leftovers) fs::remove(leftover, error);
    }
}

void remove_outdated(const fs::path& folder) {
    const SessionFiles files = session_files(folder);
    if (files.checkpoints.size() < 2) return;
    const std::uint64_t oldest = files.checkpoints[files.checkpoints.size() - 2];
    std::error_code ignored;
    for (const std::uint64_t number : files.checkpoints) {
        if (number < oldest) fs::remove(checkpoint_path(folder, number), ignored);
    }
    for (const std::uint64_t number : files.journals) {
        if (number < oldest) fs::remove(journal_path(folder, number), ignored);
    }
}

void force_to_disk(const fs::path& path) {
    const FileHandle file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.descriptor() >= 0 && ::fsync(file.descriptor()) == 0) return;
    throw Error(ErrorCode::Io, "cannot sync '" + path.string() + "' to disk: " + std::strerror(errno));
}

}  // namespace tessera::master
