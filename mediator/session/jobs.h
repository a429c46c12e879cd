#pragma once

#include <cstdint>
#include <string>
#include <tuple>

#include "mediator/session/view_summary.h"

// Pictures rendered without a connected client.
namespace tessera::session {

// The user (of the key) who submitted the job, and its name, unique per user.
struct JobName {
    std::string user;  // "" = the requesting user
    std::string name;
    friend auto operator<=>(const JobName&, const JobName&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "user", &JobName::user), row(2, "name", &JobName::name));
    }
};

struct JobStatus {
    JobName job;
    std::string scene;            // its title
    bool has_ended = false;       // the picture can be fetched, or the summary says why there is none
    ViewProgress progress;        // until then
    ViewSummary summary;          // from then on
    std::int64_t ended_at = 0;    // ns since 1970
    std::int64_t kept_until = 0;  // its client was lost: when the job is removed, ns since 1970; 0 = it stays
    static constexpr auto describe(auto row) {
        using Self = JobStatus;
        return std::tuple(row(1, "job", &Self::job), row(2, "scene", &Self::scene),
                          row(3, "has_ended", &Self::has_ended), row(4, "progress", &Self::progress),
                          row(5, "summary", &Self::summary), row(6, "ended_at", &Self::ended_at),
                          row(7, "kept_until", &Self::kept_until));
    }
};

}  // namespace tessera::session
