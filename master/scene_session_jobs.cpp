// The jobs of a scene: views that continue when their client leaves, and their stored results.
#include <algorithm>

#include "master/scene_session.h"
#include "mediator/wire/envelope.h"

namespace tessera::master {

namespace {

bool may_see(const SessionRecord& session, const std::string& user) {
    return session.user == user || session.role == net::Role::Operator;
}

session::JobName named(const SessionRecord& session, session::JobName job) {
    if (job.user.empty()) job.user = session.user;
    return job;
}

// Views that no client named have names that are hard to type ("tessera render/4294967296").
session::JobName job_name(const ViewState& view) {
    const bool is_named = view.request.detached || view.name.find('/') == std::string::npos;
    return {view.owner.user, is_named ? view.name : "lost-" + std::to_string(view.id.value)};
}

wire::SavedView without_film(const ViewState& view) {
    return {.name = view.name,
            .owner_user = view.owner.user,
            .owner_key = view.owner.key,
            .request = view.request,
            .scene_hash_of_film = {},
            .kind = {},
            .blocks = {}};
}

std::string no_such(const session::JobName& job) {
    return "there is no job named '" + job.name + "': tessera jobs lists them";
}

}  // namespace

std::string SceneSession::submission_problem(const SessionRecord& session,
                                             const session::ViewRequest& wanted) const {
    if (session.role == net::Role::Viewer) return "a viewer cannot submit jobs: use an editor's key";
    if (services_.jobs.find({session.user, wanted.name}) != nullptr) {
        return "a job named '" + wanted.name +
               "' has ended and is stored: fetch it with --remove, cancel it, or choose another name";
    }
    return Views::job_problem(wanted);
}

// A job is on disk before it is acknowledged.
void SceneSession::record_job(SessionId session, const wire::RequestView& request, TimePoint now) {
    if (!journal_) return view_opened(session, request, {});
    const auto problem = std::make_shared<std::string>();
    std::optional<ViewId> id;
    std::optional<wire::SavedView> saved;
    for (const auto& [number, view] : views_.table().all()) {
        if (view.name != request.wanted.name) continue;
        id = number;
        saved = without_film(view);
    }
    if (!saved) return view_opened(session, request, {});
    requester_ = session;
    run(
        {.writes = true},
        [this, problem, saved](SceneAuthority&) {
            if (auto written = journal_->job_started(*saved); !written) *problem = written.error().what();
        },
        [this, problem, id, session, request](TimePoint) {
            if (!problem->empty()) views_.release(*id);
            view_opened(session, request, *problem);
        },
        now);
}

// Jobs submitted while the views of a checkpoint were being copied: their journal records are before it.
void SceneSession::add_new_jobs(std::vector<wire::SavedView>& saved) const {
    for (const auto& [id, view] : views_.table().all()) {
        const bool is_there = std::any_of(saved.begin(), saved.end(), [&](const wire::SavedView& other) {
            return other.name == view.name;
        });
        if (views_.is_job(id) && !is_there) saved.push_back(without_film(view));
    }
}

void SceneSession::store_finished_jobs(TimePoint now) {
    for (Delivery::Ended& ended : views_.take_ended_jobs()) {
        const ViewState* view = views_.table().find(ended.view);
        if (view == nullptr || !views_.is_job(ended.view)) continue;  // its client is back
        session::JobName job = job_name(*view);
        const auto orphan_time = views_.orphan_time(*view, now);
        // The views of another scene may have had the same names.
        if (orphan_time) job.name = services_.jobs.unused_name(job);
        services_.events({wire::Severity::Info, "job '" + job.name + "' of " + job.user + " has ended: " +
                                                    std::string(enumerator_name(ended.summary.outcome))});
        services_.jobs.add({.status = {.job = job,
                                       .scene = title(),
                                       .has_ended = true,
                                       .progress = {},
                                       .summary = std::move(ended.summary),
                                       .ended_at = since_1970(),
                                       .kept_until = orphan_time ? since_1970() + orphan_time->count() : 0},
                            .width = ended.header.width,
                            .height = ended.header.height,
                            .components = ended.header.components},
                           std::move(ended.picture));
        // The lost client may still return for its film.
        if (orphan_time) {
            views_.stop_keeping(ended.view);
        } else {
            views_.release(ended.view);
        }
    }
    services_.jobs.remove_expired(since_1970(), now);
    if (!is_editing()) record_job_ends(services_.jobs.take_written(), now);
}

// From now on a restarted master need not render them again.
void SceneSession::record_job_ends(std::vector<session::JobName> jobs, TimePoint now) {
    if (!journal_ || jobs.empty()) return;
    const auto problems = std::make_shared<std::vector<std::string>>();
    run(
        {.writes = true},
        [this, problems, jobs = std::move(jobs)](SceneAuthority&) {
            for (const session::JobName& job : jobs) {
                if (auto written = journal_->job_ended(job); !written)
                    problems->emplace_back(written.error().what());
            }
        },
        [this, problems](TimePoint) {
            for (const std::string& problem : *problems) services_.events({wire::Severity::Error, problem});
        },
        now);
}

const ViewState* SceneSession::job_view(const session::JobName& job) const {
    for (const auto& [id, view] : views_.table().all()) {
        if (views_.is_job(id) && job_name(view) == job) return &view;
    }
    return nullptr;
}

void SceneSession::handle(SessionRecord& session, const wire::ReadJobs& request, TimePoint now) {
    wire::Jobs answer{.request = request.request, .jobs = {}};
    for (const JobStore::Entry* stored : services_.jobs.all()) {
        if (may_see(session, stored->job.status.job.user)) answer.jobs.push_back(stored->job.status);
    }
    for (const auto& [id, view] : views_.table().all()) {
        if (!views_.is_job(id) || !may_see(session, view.owner.user)) continue;
        const auto orphan_time = views_.orphan_time(view, now);
        answer.jobs.push_back({.job = job_name(view),
                               .scene = title(),
                               .progress = views_.progress(view),
                               .summary = {},
                               .kept_until = orphan_time ? since_1970() + orphan_time->count() : 0});
    }
    net::Bytes message = wire::encode(wire::ControlMessage(answer));
    while (!wire::fits_control(message)) {  // drop the oldest
        answer.jobs.erase(answer.jobs.begin(),
                          answer.jobs.begin() + static_cast<std::ptrdiff_t>((answer.jobs.size() + 1) / 2));
        message = wire::encode(wire::ControlMessage(answer));
    }
    services_.outbox.control(session.control, std::move(message));
}

void SceneSession::handle(SessionRecord& session, const wire::FetchJob& request) {
    const session::JobName job = named(session, request.job);
    const JobStore::Entry* stored = may_see(session, job.user) ? services_.jobs.find(job) : nullptr;
    if (stored == nullptr) {
        const bool is_rendered = may_see(session, job.user) && job_view(job) != nullptr;
        return done(
            session, request.request,
            is_rendered ? "job '" + job.name + "' is still being rendered: try again later" : no_such(job));
    }
    constexpr std::size_t MaxOnTheirWay = 16;
    if (views_.frames_in_flight(session.id) >= MaxOnTheirWay)
        return done(session, request.request,
                    "too many pictures are already in flight to this client: fetch them first");
    done(session, request.request, {});
    const session::ViewSummary& summary = stored->job.status.summary;
    views_.send_kept(session, {.view = {},
                               .header = {.view = request.number,
                                          .version = summary.version,
                                          .width = stored->job.width,
                                          .height = stored->job.height,
                                          .components = stored->job.components,
                                          .encoding = summary.picture.encoding,
                                          .picture_bytes = stored->picture->size(),
                                          .film_window = {},
                                          .min_samples = summary.min_samples,
                                          .max_samples = summary.max_samples,
                                          .complete = true},
                               .summary = summary,
                               .picture = stored->picture});
}

void SceneSession::handle(SessionRecord& session, const wire::CancelJob& request, TimePoint now) {
    const session::JobName job = named(session, request.job);
    if (!may_see(session, job.user)) return done(session, request.request, no_such(job));
    const bool was_kept = services_.jobs.remove(job);
    const ViewState* view = job_view(job);
    if (view == nullptr) return done(session, request.request, was_kept ? "" : no_such(job));
    record_job_ends({{view->owner.user, view->name}}, now);
    views_.release(view->id);
    done(session, request.request, {});
}

}  // namespace tessera::master
