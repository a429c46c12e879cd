#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "master/peers/event.h"
#include "mediator/base/task_thread.h"
#include "mediator/session/jobs.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

// Jobs that have ended, until their users have them removed. With a session folder each is a file there, named by a
// hash, and outlives the master. One thread; files are written by another.
class KeptJobs {
  public:
    struct Entry {
        wire::KeptJob job;
        std::shared_ptr<const std::vector<std::byte>> picture;  // never null; empty = there is none
        std::uint64_t order = 0;                                // of their ends
    };

    explicit KeptJobs(EventSink events) : events_(std::move(events)) {}
    ~KeptJobs();  // waits for the disk

    // Takes what lies in the folder, which is made when it is not there; damaged files stay and are told. Throws
    // Error{Io} when it cannot be used.
    void record_to(const std::filesystem::path& folder);

    // In place of one of that name. The oldest go when there are too many, or too large ones.
    void add(wire::KeptJob&& job, std::shared_ptr<const std::vector<std::byte>> picture);
    const Entry* find(const session::JobName& job) const;
    bool remove(const session::JobName& job);  // false: there is none
    // Those whose files were written since the last call.
    std::vector<session::JobName> take_written();
    std::vector<const Entry*> all() const;  // oldest first

  private:
    std::filesystem::path path_of(const session::JobName& job) const;
    void make_room();

    static constexpr std::size_t MaxJobs = 256;
    static constexpr std::uint64_t MaxBytes = std::uint64_t{1} << 30;  // of pictures

    EventSink events_;
    std::filesystem::path folder_;  // empty = in memory alone
    std::map<session::JobName, Entry> jobs_;
    std::uint64_t bytes_ = 0, next_order_ = 1;
    std::mutex mutex_;  // protects written_
    std::vector<session::JobName> written_;
    std::unique_ptr<TaskThread> disk_;  // with a folder; last: its tasks use what is above
};

}  // namespace tessera::master
