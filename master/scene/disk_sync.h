#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "master/scene/journal_file.h"
#include "mediator/base/clock.h"

namespace tessera::master {

// Syncs files to disk on a background thread, at most once per interval: everything written before the last sync
// survives a power failure.
class DiskSync {
  public:
    explicit DiskSync(Duration interval);
    ~DiskSync();  // syncs once more
    DiskSync(const DiskSync&) = delete;
    DiskSync& operator=(const DiskSync&) = delete;

    // In the order of these calls. `failed` is called on the thread that syncs: what was written may be lost, even if
    // it can still be read.
    void soon(const FilePtr& file, std::function<void()> failed = {});
    std::string problem() const;  // the first error; empty = none
    std::uint64_t failures() const;
    void forget_problem();  // what it was about has been written elsewhere

  private:
    void run(const std::stop_token& stop);

    const Duration interval_;
    struct DirtyFile {
        FilePtr file;
        std::function<void()> failed;
    };
    mutable std::mutex mutex_;  // protects the three below
    std::vector<DirtyFile> dirty_;
    std::string problem_;
    std::uint64_t failures_ = 0;
    std::condition_variable_any wake_;
    std::jthread thread_;
};

}  // namespace tessera::master
