#pragma once

#include <condition_variable>
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

    void soon(const FilePtr& file);  // in the order of these calls
    std::string problem() const;     // the first error; empty = none
    void forget_problem();           // what it was about has been written elsewhere

  private:
    void run(const std::stop_token& stop);

    const Duration interval_;
    mutable std::mutex mutex_;  // protects the two below
    std::vector<FilePtr> dirty_;
    std::string problem_;
    std::condition_variable_any wake_;
    std::jthread thread_;
};

}  // namespace tessera::master
