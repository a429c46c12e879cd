#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "mediator/session/jobs.h"

// Messages between clients and the master about jobs: views requested as `detached`. Only the user who submitted a job
// and operators may list, fetch and cancel it. `request` is the client's request number and is repeated in the reply.
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
// Answered by RequestDone; then its frame and ViewDone are sent as those of the client's view `number`.
struct FetchJob {
    std::uint64_t request = 0, number = 0;
    session::JobName job;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &FetchJob::request), row(2, "number", &FetchJob::number),
                          row(3, "job", &FetchJob::job));
    }
};
// Ends the job and deletes its picture. Answered by RequestDone.
struct CancelJob {
    std::uint64_t request = 0;
    session::JobName job;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &CancelJob::request), row(2, "job", &CancelJob::job));
    }
};

}  // namespace tessera::wire
