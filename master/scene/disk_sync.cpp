#include "master/scene/disk_sync.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace tessera::master {

DiskSync::DiskSync(Duration interval)
    : interval_(interval), thread_([this](const std::stop_token& stop) { run(stop); }) {}

DiskSync::~DiskSync() {
    thread_.request_stop();
    thread_.join();
}

void DiskSync::soon(const FilePtr& file, std::function<void()> failed) {
    const std::scoped_lock lock(mutex_);
    const bool is_dirty =
        std::ranges::any_of(dirty_, [&](const DirtyFile& each) { return each.file == file; });
    if (!is_dirty) dirty_.push_back({file, std::move(failed)});
    wake_.notify_one();
}

std::string DiskSync::problem() const {
    const std::scoped_lock lock(mutex_);
    return problem_;
}

std::uint64_t DiskSync::failures() const {
    const std::scoped_lock lock(mutex_);
    return failures_;
}

void DiskSync::forget_problem() {
    const std::scoped_lock lock(mutex_);
    problem_.clear();
}

void DiskSync::run(const std::stop_token& stop) {
    bool last = false;
    while (!last) {
        std::vector<DirtyFile> files;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, stop, [&] { return !dirty_.empty(); });
            last = stop.stop_requested();
            files.swap(dirty_);
        }
        for (const DirtyFile& each : files) {
            if (::fdatasync(each.file->descriptor()) == 0) continue;
            const std::string reason = std::strerror(errno);
            if (each.failed) each.failed();  // before anyone learns of the problem
            const std::scoped_lock lock(mutex_);
            ++failures_;
            if (problem_.empty()) problem_ = "the journal cannot be written to disk: " + reason;
        }
        if (last) return;
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, stop, interval_, [] { return false; });
    }
}

}  // namespace tessera::master
