// The end of a job: the picture is made, then the summary, the picture and the merged film go to the client.
#include <algorithm>
#include <span>

#include "master/render/job_runner.h"

namespace tessera::master {

namespace {
constexpr std::uint32_t TilesAhead = 32;  // encoded by the merger and not yet sent
constexpr std::size_t PictureChunk = std::size_t{1} << 20;
constexpr std::size_t BytesAhead = std::size_t{32} << 20;  // waiting for a slow client
}  // namespace

void JobRunner::begin_filtering(TimePoint now) {
    const wire::StartJob& request = job_->request;
    if (request.picture == wire::PictureEncoding::None || job_->stage ||
        job_->scheduler->merged_samples() == 0) {
        return begin_delivery(now);
    }
    job_->phase = wire::JobPhase::Filtering;
    job_->last_progress_sent = {};
    merger_.reconstruct(request.job, request.view, request.picture, FilmMerger::FilmHash::NotWanted);
}

void JobRunner::take(Reconstructed&& made, TimePoint now) {
    job_->picture = std::move(made.picture);
    job_->samples_least = made.samples_least;
    job_->samples_most = made.samples_most;
    wire::PictureSummary& summary = job_->picture->summary;
    summary.seconds_predicted = job_->predicted_seconds;
    summary.scale = job_->scale;
    if (job_->scale > 1) {
        summary.notes.push_back("the time is too short for 2 samples in every pixel: rendered at 1/" +
                                std::to_string(job_->scale) + " of the size and upsampled");
    }
    if (job_->request.budget > Duration::zero() && *job_->outcome == wire::JobOutcome::TimeUp) {
        const std::uint64_t pixels =
            job_->scale == 1 ? job_->request.view.window.pixel_count() : job_->full_pixels;
        time_budget_.measured(job_->way, pixels, seconds(now - *job_->deadline));
    }
    if (!job_->picture->error.empty()) {
        job_->outcome = wire::JobOutcome::Failed;
        job_->message = job_->picture->error;
    }
    begin_delivery(now);
}

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
    const std::uint32_t count = tiles_to_deliver();
    const std::uint64_t picture_size = job_->picture ? job_->picture->bytes->size() : 0;
    if (job_->tiles_sent == count && job_->picture_sent == picture_size) return abandon();  // all done
    const SessionRecord* session = sessions_.find(job_->session);
    if (session == nullptr || !session->bulk) return;
    while (job_->picture_sent < picture_size) {  // what somebody is waiting for goes first
        if (outbox_.waiting_bytes(net::Link::Bulk, *session->bulk) > BytesAhead) return;
        const auto piece =
            std::span(*job_->picture->bytes)
                .subspan(job_->picture_sent)
                .first(std::min<std::uint64_t>(PictureChunk, picture_size - job_->picture_sent));
        outbox_.bulk(*session->bulk, wire::PictureChunk{.job = job_->request.job,
                                                        .total = picture_size,
                                                        .offset = job_->picture_sent,
                                                        .data = {piece.begin(), piece.end()}});
        job_->picture_sent += piece.size();
    }
    if (job_->tiles_sent == count) return abandon();
    if (outbox_.waiting_bytes(net::Link::Bulk, *session->bulk) > BytesAhead) return;
    const std::uint32_t until = std::min(count, job_->tiles_sent + TilesAhead);
    if (until > job_->tiles_requested) {
        merger_.deliver(view().id, job_->request.job, job_->tiles_requested, until);
        job_->tiles_requested = until;
    }
}

std::uint32_t JobRunner::tiles_to_deliver() const {
    return job_->scheduler && job_->request.film ? static_cast<std::uint32_t>(job_->scheduler->tiles().size())
                                                 : 0u;
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
        done.tiles = tiles_to_deliver();
        done.seconds_render = seconds(*job.ended - job.rendering_since);
        done.samples = job.scheduler->merged_samples();
        done.units = job.scheduler->counts();
    }
    if (job.picture) {
        done.picture = job.picture->summary;
        done.samples_least = job.samples_least;
        done.samples_most = job.samples_most;
    }
    if (job.first_picture) done.first_picture_seconds = seconds(*job.first_picture - job.started);
    for (const auto& [id, node] : job.nodes) done.nodes.push_back(node);
    done.wire_bytes = {.control = outbox_.bytes.control - job.bytes_before.control,
                       .blobs = outbox_.bytes.blobs - job.bytes_before.blobs,
                       .film = outbox_.bytes.film - job.bytes_before.film};
    return done;
}

}  // namespace tessera::master
