// The end of a job: the summary, and the merged film on its way to the client.
#include <algorithm>

#include "master/job_runner.h"

namespace tessera::master {

namespace {
constexpr std::uint32_t TilesAhead = 32;                   // encoded by the merger and not yet sent
constexpr std::size_t BytesAhead = std::size_t{32} << 20;  // waiting for a slow client
}  // namespace

void JobRunner::begin_delivery(TimePoint now) {
    job_->phase = wire::JobPhase::Delivering;
    job_->ended = now;
    const SessionRecord* session = sessions_.find(job_->session);
    if (session == nullptr) return abandon();
    job_->last_progress_sent = {};  // the last word is not held back
    send_progress(now);
    outbox_.control(session->control, summary());
    deliver();
}

void JobRunner::deliver() {
    const auto count = job_->scheduler ? static_cast<std::uint32_t>(job_->scheduler->tiles().size()) : 0u;
    if (job_->tiles_sent == count) return abandon();  // all done: close views and film
    const SessionRecord* session = sessions_.find(job_->session);
    if (session == nullptr || !session->bulk) return;
    if (outbox_.waiting_bytes(net::Link::Bulk, *session->bulk) > BytesAhead) return;
    const std::uint32_t until = std::min(count, job_->tiles_sent + TilesAhead);
    if (until > job_->tiles_requested) {
        merger_.deliver(job_->request.job, job_->tiles_requested, until);
        job_->tiles_requested = until;
    }
}

void JobRunner::send_progress(TimePoint now) {
    if (now - job_->last_progress_sent < settings_.progress_interval) return;
    const SessionRecord* session = sessions_.find(job_->session);
    if (session == nullptr) return;
    job_->last_progress_sent = now;
    std::uint32_t nodes = 0;
    for (const auto& [id, node] : nodes_.all()) nodes += ready(node) ? 1 : 0;
    const wire::StartJob& request = job_->request;
    outbox_.control(session->control,
                    wire::JobProgress{.job = request.job,
                                      .phase = job_->phase,
                                      .samples = job_->scheduler ? job_->scheduler->merged_samples() : 0,
                                      .samples_expected = request.view.window.pixel_count() * request.spp,
                                      .rays = job_->rays,
                                      .nodes = nodes,
                                      .elapsed = job_->scheduler ? now - job_->rendering_since : Duration{}});
}

wire::JobDone JobRunner::summary() const {
    const Job& job = *job_;
    wire::JobDone done{.job = job.request.job,
                       .outcome = *job.outcome,
                       .message = job.message,
                       .version = job.version,
                       .seed = job.request.view.seed,
                       .rays = job.rays,
                       .nonfinite_samples = job.nonfinite_samples,
                       .triangles = triangles_,
                       .instances = instances_,
                       .lights = lights_};
    if (job.scheduler) {
        done.tiles = static_cast<std::uint32_t>(job.scheduler->tiles().size());
        done.seconds_render = seconds(*job.ended - job.rendering_since);
        done.samples = job.scheduler->merged_samples();
        done.units = job.scheduler->counts();
    }
    if (job.first_picture) done.first_picture_seconds = seconds(*job.first_picture - job.started);
    for (const auto& [id, node] : job.nodes) done.nodes.push_back(node);
    done.wire_bytes = {.control = outbox_.bytes.control - job.bytes_before.control,
                       .blobs = outbox_.bytes.blobs - job.bytes_before.blobs,
                       .film = outbox_.bytes.film - job.bytes_before.film};
    return done;
}

}  // namespace tessera::master
