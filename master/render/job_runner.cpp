#include "master/render/job_runner.h"

#include <algorithm>

#include "master/peers/suitable_nodes.h"

namespace tessera::master {

namespace {

constexpr std::uint64_t UnitsPerJob = std::uint64_t{1} << 40;  // ids of two jobs never meet

}  // namespace

JobRunner::JobRunner(const JobSettings& settings, NodeTable& nodes, SessionTable& sessions, Outbox& outbox,
                     EventSink events, std::function<void()> wake)
    : settings_(settings),
      nodes_(nodes),
      sessions_(sessions),
      outbox_(outbox),
      events_(std::move(events)),
      merger_(std::move(wake)) {}

std::optional<SessionId> JobRunner::session() const {
    if (!job_) return std::nullopt;
    return job_->session;
}

void JobRunner::start(SessionId session, wire::StartJob request, Version version, TimePoint now) {
    request.view.id = ViewId{next_view_++};
    request.view.revision = 1;
    if (request.budget > Duration::zero() || (request.time_limit > Duration::zero() && request.spp == 0))
        request.spp = MaxSamplesPerPixel;
    job_.emplace();
    job_->request = std::move(request);
    complete(job_->request.view);
    job_->way = way_of(job_->request);
    job_->session = session;
    job_->version = version;
    job_->tile_edge = choose_tile_edge(job_->request);
    job_->started = job_->without_nodes_since = now;
    job_->bytes_before = bytes_before_;
    tick(now);
}

bool JobRunner::suits(const NodeRecord& node) const {
    const wire::StartJob& request = job_->request;
    return master::suits(node, request.view, job_->version) &&
           (!request.reproducible || node.hello.reproducible);
}

bool JobRunner::ready(const NodeRecord& node) const {
    return suits(node) && master::ready(node, job_->request.view, job_->version);
}

void JobRunner::tick(TimePoint now) {
    take_merger_output(now);
    if (!job_) return;
    switch (job_->phase) {
        case wire::JobPhase::WaitingForNodes:
        case wire::JobPhase::Syncing:
            wait_for_nodes(now);
            break;
        case wire::JobPhase::Rendering:
            render(now);
            break;
        case wire::JobPhase::Filtering:
            break;  // until the merger answers
        case wire::JobPhase::Delivering:
            deliver();
            break;
    }
    if (job_ && job_->phase != wire::JobPhase::Delivering) send_progress(now);
}

void JobRunner::wait_for_nodes(TimePoint now) {
    std::uint32_t suitable = 0, prepared = 0;
    for (const auto& [id, node] : nodes_.all()) {
        suitable += suits(node) ? 1 : 0;
        prepared += ready(node) ? 1 : 0;
    }
    const std::uint32_t wanted = std::max(1u, job_->request.wait_nodes);
    if (prepared >= wanted) {
        if (budget_is_planned(now)) begin_rendering(now);
        return;
    }
    if (suitable >= wanted) {
        job_->phase = wire::JobPhase::Syncing;
        job_->without_nodes_since = now;
        return;
    }
    job_->phase = wire::JobPhase::WaitingForNodes;
    if (now - job_->without_nodes_since >= job_->request.wait_limit) {
        decide(wire::JobOutcome::NoNodes,
               obstacles(nodes_, job_->request.view, job_->version) + std::to_string(suitable) + " of " +
                   std::to_string(wanted) +
                   " nodes came: start more nodes or ask for fewer with --wait-nodes",
               now);
        begin_delivery(now);
    }
}

void JobRunner::begin_rendering(TimePoint now) {
    const wire::StartJob& request = job_->request;
    choose_scale(now);
    job_->phase = wire::JobPhase::Rendering;
    job_->rendering_since = now;
    if (request.time_limit > Duration::zero() && !job_->deadline) job_->deadline = now + request.time_limit;
    begin_picture(now);
}

// The film of the stage, or of the picture itself.
void JobRunner::begin_picture(TimePoint now) {
    const wire::StartJob& request = job_->request;
    // A batch frame shows its first picture at 4 samples; against the clock every round counts, but a
    // variance, which filters need, takes 2.
    const std::uint32_t first_level = !job_->deadline ? 2u : request.budget > Duration::zero() ? 1u : 0u;
    const PlanSettings plan{.window = view().window,
                            .tile = job_->tile_edge,
                            .spp = job_->stage ? 1 : request.spp,
                            .policy = request.policy,
                            .first_level = job_->stage ? 0u : first_level};
    job_->scheduler.emplace(plan, view().id, view().revision, job_->version, UnitId{next_unit_},
                            job_->deadline);
    next_unit_ += UnitsPerJob;
    merger_.open(view().id, view().revision,
                 FrameAssembler(job_->scheduler->tiles(), view().channels, plan.spp));
    render(now);
}

void JobRunner::render(TimePoint now) {
    Scheduler& scheduler = *job_->scheduler;
    if (!job_->outcome) {
        const bool stage_is_over =
            scheduler.complete() || (job_->stage_deadline && now >= *job_->stage_deadline);
        if (job_->stage && stage_is_over) {
            cancel(scheduler.cancel_everything());
            close_view(view().id);
            merger_.keep_features(view().id, job_->request.view.id);
            job_->stage.reset();
            return begin_picture(now);
        }
        if (scheduler.complete()) {
            decide(wire::JobOutcome::Complete, {}, now);
        } else if (time_is_up(now)) {
            decide(wire::JobOutcome::TimeUp, {}, now);
        } else {
            collect_overdue(now);
            deal(now);
        }
    }
    if (job_->outcome && (scheduler.idle() || now - job_->outcome_at > settings_.stop_grace))
        begin_filtering(now);
}

void JobRunner::deal(TimePoint now) {
    std::vector<NodeCapacity> capacities;
    for (const auto& [id, node] : nodes_.all()) {
        if (ready(node)) capacities.push_back(node.capacity());
    }
    if (!capacities.empty()) {
        job_->without_nodes_since = now;
    } else if (now - job_->without_nodes_since >= job_->request.wait_limit) {
        return decide(wire::JobOutcome::NoNodes, "all nodes are gone: what was merged so far is delivered",
                      now);
    }
    for (const Assignment& assignment : job_->scheduler->assign(capacities, balancer_, now)) {
        NodeRecord& node = *nodes_.find(assignment.node);
        if (auto opening = node.opening(view())) outbox_.control(node.control, *std::move(opening));
        node.pending[assignment.unit.id] = ++node.work_sequence;
        outbox_.control(node.control, wire::Work{node.work_sequence, assignment.unit});
    }
}

void JobRunner::collect_overdue(TimePoint now) {
    for (auto& [id, node] : nodes_.all()) {
        const auto held = job_->scheduler->held_by(id);
        for (const UnitId unit : NodeTable::overdue(node, held, now, settings_.overdue_patience)) {
            job_->scheduler->released(unit, id, Scheduler::Loss::Lost);
        }
        if (node.stuck) job_->scheduler->node_gone(id);
    }
}

void JobRunner::film(net::PeerId bulk_peer, net::Bytes message) {
    merger_.push(bulk_peer, std::move(message));
}

void JobRunner::take_merger_output(TimePoint now) {
    for (MergerOutput& output : merger_.take()) {
        if (const auto* report = std::get_if<MergeReport>(&output)) {
            take(*report, now);
            continue;
        }
        if (const auto* rehearsed = std::get_if<Rehearsed>(&output)) {
            if (!job_ || rehearsed->job != job_->request.job) continue;
            time_budget_.measured(job_->way, rehearsed->pixels, rehearsed->seconds);
            continue;
        }
        if (auto* made = std::get_if<Reconstructed>(&output)) {
            if (!job_ || made->job != job_->request.job || job_->phase != wire::JobPhase::Filtering) continue;
            take(std::move(*made), now);
            continue;
        }
        auto* delivered = std::get_if<EncodedTile>(&output);
        if (delivered == nullptr) continue;
        EncodedTile& tile = *delivered;
        if (!job_ || tile.job != job_->request.job) continue;
        const SessionRecord* session = sessions_.find(job_->session);
        if (session == nullptr || !session->bulk) continue;
        outbox_.bulk(*session->bulk, std::move(tile.bytes), &wire::WireBytes::film);
        ++job_->tiles_sent;
    }
}

void JobRunner::take(const MergeReport& report, TimePoint now) {
    NodeRecord* node = nodes_.by_bulk(report.peer);
    if (report.malformed) {
        ++malformed_film_;
        events_({wire::Severity::Warning, "malformed film was dropped"});
        return;
    }
    if (report.stale || !job_ || !job_->scheduler || view().id != report.view) return;
    Scheduler& scheduler = *job_->scheduler;
    switch (report.result.outcome) {
        case FrameAssembler::Outcome::Misfit:
            scheduler.count_refused();
            events_({wire::Severity::Error, "film that does not fit the frame was refused" +
                                                (node ? " (node " + node->hello.name + ")" : std::string())});
            return;
        case FrameAssembler::Outcome::Contradiction: {
            const auto unit = scheduler.find(report.unit);
            events_({wire::Severity::Error,
                     "two nodes gave different bits for samples " + std::to_string(report.block.first) +
                         ".." + std::to_string(report.block.end()) +
                         (node ? " (second: " + node->hello.name + ")" : "") +
                         (unit ? "; replay: tessera probe SCENE --pixel " + std::to_string(unit->tile.x) +
                                     "," + std::to_string(unit->tile.y) + " --sample " +
                                     std::to_string(report.block.first)
                               : "")});
            scheduler.count_duplicate();
            break;
        }
        case FrameAssembler::Outcome::Duplicate:
            scheduler.count_duplicate();
            break;
        case FrameAssembler::Outcome::Merged:
            if (node) account(report, *node);
            job_->rays += report.part == 0 ? report.rays : 0;
            job_->nonfinite_samples += report.nonfinite;
            break;
    }
    if (node && report.part == 0 && report.parts == 1) {
        balancer_.measured(node->id, report.pixel_samples, report.busy);
    }
    cancel(scheduler.merged(report.unit, report.result.tile, report.block));
    if (!job_->first_picture && !job_->stage && scheduler.tiles_without_samples() == 0)
        job_->first_picture = now;
}

void JobRunner::account(const MergeReport& report, NodeRecord& node) {
    wire::NodeSummary& part = job_->nodes[node.id];
    part.id = node.id;
    part.name = node.hello.name;
    part.host = node.hello.host;
    part.backend = node.hello.backend;
    part.kind = node.hello.kind;
    part.pid = node.hello.pid;
    part.units += report.part == 0 ? 1 : 0;
    part.samples += report.pixel_samples;
    part.seconds_busy += report.part == 0 ? seconds(report.busy) : 0.0;
}

void JobRunner::cancel(const std::vector<Cancellation>& cancellations) {
    std::map<NodeId, std::vector<UnitId>> by_node;
    for (const Cancellation& cancellation : cancellations)
        by_node[cancellation.node].push_back(cancellation.unit);
    constexpr std::size_t PerMessage = 1024;
    for (const auto& [id, units] : by_node) {
        const NodeRecord* node = nodes_.find(id);
        for (std::size_t i = 0; node != nullptr && i < units.size(); i += PerMessage) {
            const auto begin = units.begin() + static_cast<std::ptrdiff_t>(i);
            const auto end =
                units.begin() + static_cast<std::ptrdiff_t>(std::min(units.size(), i + PerMessage));
            outbox_.control(node->control, wire::CancelUnits{{begin, end}});
        }
    }
}

void JobRunner::released(NodeRecord& node, const wire::UnitReleased& release, TimePoint now) {
    if (!job_ || !job_->scheduler) return;
    node.pending.erase(release.unit);
    job_->scheduler->released(release.unit, node.id, Scheduler::Loss::Released);
    switch (release.reason) {
        case wire::ReleaseReason::Cancelled:
        case wire::ReleaseReason::Leaving:
            return;
        case wire::ReleaseReason::UnknownView:
            node.views.erase(view().id);  // the message got lost: say it again
            job_->scheduler->count_refused();
            return;
        case wire::ReleaseReason::OtherVersion:
            job_->scheduler->count_refused();
            return;
        case wire::ReleaseReason::Failed:
            job_->scheduler->count_refused();
            events_({wire::Severity::Error, "node " + node.hello.name + ": " + release.message});
            if (++job_->failures >= settings_.failure_limit) {
                decide(wire::JobOutcome::Failed, release.message, now);
            }
            return;
    }
}

void JobRunner::goodbye(NodeRecord& node, const wire::Goodbye& goodbye) {
    if (!job_ || !job_->scheduler) return;
    for (const UnitId unit : job_->scheduler->held_by(node.id)) {
        const auto& sent = goodbye.units_sent;
        // Film that was sent is on its way on the other link; the overdue check catches it if it never comes.
        if (std::find(sent.begin(), sent.end(), unit) != sent.end()) continue;
        job_->scheduler->released(unit, node.id, Scheduler::Loss::Released);
    }
}

void JobRunner::node_gone(NodeId node) {
    balancer_.forget(node);
    if (job_ && job_->scheduler) job_->scheduler->node_gone(node);
}

void JobRunner::scene_facts(const wire::VersionReport& report) {
    triangles_ = report.triangles;
    instances_ = report.instances;
    lights_ = report.lights;
}

void JobRunner::stop(JobId job, TimePoint now) {
    if (!job_ || job_->request.job != job || job_->outcome) return;
    decide(wire::JobOutcome::Stopped, "stopped by the client", now);
    if (!job_->rendering()) begin_delivery(now);
}

void JobRunner::decide(wire::JobOutcome outcome, std::string message, TimePoint now) {
    if (job_->outcome) return;
    job_->outcome = outcome;
    job_->outcome_at = now;
    job_->message = std::move(message);
    if (job_->scheduler) cancel(job_->scheduler->cancel_everything());
}

void JobRunner::close_view(ViewId closed) {
    for (auto& [id, node] : nodes_.all()) {
        if (node.views.erase(closed) > 0) outbox_.control(node.control, wire::CloseView{closed});
    }
}

void JobRunner::abandon() {
    if (!job_) return;
    if (job_->scheduler) {
        cancel(job_->scheduler->cancel_everything());
        add(total_, job_->scheduler->counts());
    }
    close_view(view().id);
    merger_.close(view().id);
    if (job_->stage) merger_.close(job_->request.view.id);
    job_.reset();
}

TimePoint JobRunner::next_event(TimePoint now) const {
    if (!job_) return TimePoint::max();
    TimePoint next = now + settings_.progress_interval;
    for (const auto& deadline : {job_->stage ? job_->stage_deadline : std::nullopt, job_->deadline}) {
        if (deadline && !job_->outcome && now < *deadline) next = std::min(next, *deadline);
    }
    return next;
}

}  // namespace tessera::master
