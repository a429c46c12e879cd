#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "master/peers/event.h"
#include "mediator/base/clock.h"
#include "mediator/base/task_thread.h"
#include "mediator/session/jobs.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

// Finished jobs, kept until their users remove them. With a session folder each is a file, named by a hash, and
// survives the master. Single-threaded; files are written by a background thread.
class JobStore {
  public:
    struct Entry {
        wire::StoredJob job;
        std::shared_ptr<const std::vector<std::byte>> picture;  // never null; empty = no picture
        std::uint64_t order = 0;                                // by end time
        std::optional<TimePoint> expires{};                     // known from the first remove_expired() on
    };

    explicit JobStore(EventSink events) : events_(std::move(events)) {}
    ~JobStore();  // waits for the disk

    // Loads the jobs in the folder and creates it if needed; damaged files are reported and left there. Throws
    // Error{Io} if the folder cannot be used.
    void record_to(const std::filesystem::path& folder);

    // Replaces a job of that name. Removes the oldest jobs when there are too many or they are too large.
    void add(wire::StoredJob&& job, std::shared_ptr<const std::vector<std::byte>> picture);
    const Entry* find(const session::JobName& job) const;
    bool remove(const session::JobName& job);  // false: no such job
    // The job's name, or with a number appended if a job of that name is stored.
    std::string unused_name(const session::JobName& job) const;
    // `since_1970` in ns: of a job that was stored by an earlier master it says how long it is still kept. From then on `now`
    // counts, so that a wall clock that is set removes nothing.
    void remove_expired(std::int64_t since_1970, TimePoint now);
    // Jobs whose files were written since the last call.
    std::vector<session::JobName> take_written();
    std::vector<const Entry*> all() const;  // oldest first

  private:
    std::filesystem::path path_of(const session::JobName& job) const;
    void evict_oldest();

    static constexpr std::size_t MaxJobs = 256;
    static constexpr std::uint64_t MaxBytes = std::uint64_t{1} << 30;  // of pictures

    EventSink events_;
    std::filesystem::path folder_;  // empty = in memory only
    std::map<session::JobName, Entry> jobs_;
    std::uint64_t bytes_ = 0, next_order_ = 1;
    std::mutex mutex_;  // protects written_
    std::vector<session::JobName> written_;
    std::unique_ptr<TaskThread> disk_;  // only with a folder; the last member, since its tasks use the others
};

}  // namespace tessera::master
