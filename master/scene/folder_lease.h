#pragma once

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "mediator/base/clock.h"

namespace tessera::master {

// The file `owner` in a session folder: which master records there. A lock keeps a second master of the same machine
// out; on a network file system, where locks may not reach other machines, this file does. Its owner refreshes it, and
// stops recording when the file names another master. Thread-safe.
class FolderLease {
  public:
    struct Settings {
        Duration refresh = std::chrono::seconds(5);         // of its time of modification
        Duration lifetime = std::chrono::seconds(30);       // unrefreshed for so long: its owner is gone
        Duration recheck = std::chrono::milliseconds(250);  // problem() reads it at most so often
    };

    // Takes the folder, which this process has locked. Throws Error{Unavailable} while the master of another machine
    // refreshes it, Error{Io} if it cannot be written.
    explicit FolderLease(std::filesystem::path folder) : FolderLease(std::move(folder), Settings{}) {}
    FolderLease(std::filesystem::path folder, const Settings& settings);
    ~FolderLease();  // gives it back
    FolderLease(const FolderLease&) = delete;
    FolderLease& operator=(const FolderLease&) = delete;

    // Why this master may not record now; "" = it may. Once another one has taken the folder, it stays so.
    std::string problem();
    // The reason, once another one has taken it; "" = not known. Does not look at the file.
    std::string lost_reason();

  private:
    void take();
    void check();
    void refresh(const std::stop_token& stop);

    const std::filesystem::path folder_, path_;
    const Settings settings_;
    const std::string content_;
    std::mutex mutex_;  // protects the three below
    std::string problem_;
    bool is_lost_ = false;
    TimePoint checked_at_{};
    std::condition_variable_any wake_;
    std::jthread thread_;
};

}  // namespace tessera::master
