#include "master/scene/disk_sync.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace tessera::master {

DiskSync::DiskSync(Duration interval)
    : interval_(interval), thread_([this](const std::stop_token& stop) { run(stop); }) {}

DiskSync::~DiskSync() {
    thread_.request_stop();
    thread_.join();
}

void DiskSync::soon(const FilePtr& file) {
    const std::scoped_lock lock(mutex_);
    if (std::find(dirty_.begin(), dirty_.end(), file) == dirty_.end()) dirty_.push_back(file);
    wake_.notify_one();
}

std::string DiskSync::problem() const {
    const std::scoped_lock lock(mutex_);
    return problem_;
}

void DiskSync::forget_problem() {
    const std::scoped_lock lock(mutex_);
    problem_.clear();
}

void DiskSync::run(const std::stop_token& stop) {
    bool last = false;
    while (!last) {
        std::vector<FilePtr> files;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, stop, [&] { return !dirty_.empty(); });
            last = stop.stop_requested();
            files.swap(dirty_);
        }
        for (const FilePtr& file : files) {
            if (::fdatasync(file->descriptor()) == 0) continue;
            const std::string reason = std::strerror(errno);
            const std::scoped_lock lock(mutex_);
            if (problem_.empty()) problem_ = "the journal cannot be written to disk: " + reason;
        }
        if (last) return;
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, stop, interval_, [] { return false; });
    }
}

}  // namespace tessera::master
