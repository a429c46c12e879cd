#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "mediator/session/jobs.h"

// What clients and the master say to each other about jobs: views that were requested as `detached`. A job is listed
// to, fetched and cancelled by the user who submitted it, and by operators. `request` is the asking client's number and
// comes back with the answer.
namespace tessera::wire {

struct ReadJobs {
    std::uint64_t request = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "request", &ReadJobs::request)); }
};
struct Jobs {
    std::uint64_t request = 0;
    std::vector<session::JobStatus> jobs;  // oldest first
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &Jobs::request), row(2, "jobs", &Jobs::jobs));
    }
};
// Answered by RequestDone; then its frame and its ViewDone come as those of the client's view `number`.
struct FetchJob {
    std::uint64_t request = 0, number = 0;
    session::JobName job;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &FetchJob::request), row(2, "number", &FetchJob::number),
                          row(3, "job", &FetchJob::job));
    }
};
// Ends it, and forgets its picture. Answered by RequestDone.
struct CancelJob {
    std::uint64_t request = 0;
    session::JobName job;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &CancelJob::request), row(2, "job", &CancelJob::job));
    }
};

}  // namespace tessera::wire
