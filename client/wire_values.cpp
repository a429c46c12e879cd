#include "client/wire_values.h"

namespace tessera::client {

// Both count the same things in the same order.
static_assert(int(PictureEncoding::None) == int(wire::PictureEncoding::None));
static_assert(int(PictureEncoding::Exr) == int(wire::PictureEncoding::Exr));

namespace {

NodeShare from_wire(const wire::NodeSummary& node) {
    return {.id = node.id.value,
            .name = node.name,
            .host = node.host,
            .backend = node.backend,
            .kind = node.kind,
            .pid = node.pid,
            .units = node.units,
            .samples = node.samples,
            .seconds_busy = node.seconds_busy};
}

UnitCounts from_wire(const wire::UnitCounts& counts) {
    return {counts.issued,    counts.reissued, counts.merged, counts.duplicate,
            counts.cancelled, counts.refused,  counts.lost};
}

WireBytes from_wire(const wire::WireBytes& bytes) {
    return {bytes.control, bytes.blobs, bytes.film};
}

wire::Policy to_wire(Policy policy) {
    switch (policy) {
        case Policy::Tiled:
            return wire::Policy::Tiled;
        case Policy::Cooperative:
            return wire::Policy::Cooperative;
        case Policy::Mixed:
            break;
    }
    return wire::Policy::Mixed;
}

Phase from_wire(wire::JobPhase phase) {
    switch (phase) {
        case wire::JobPhase::WaitingForNodes:
            return Phase::WaitingForNodes;
        case wire::JobPhase::Syncing:
            return Phase::Syncing;
        case wire::JobPhase::Rendering:
            return Phase::Rendering;
        case wire::JobPhase::Filtering:
            return Phase::Filtering;
        case wire::JobPhase::Delivering:
            break;
    }
    return Phase::Delivering;
}

Outcome from_wire(wire::JobOutcome outcome) {
    switch (outcome) {
        case wire::JobOutcome::Complete:
            return Outcome::Complete;
        case wire::JobOutcome::TimeUp:
            return Outcome::TimeUp;
        case wire::JobOutcome::Stopped:
            return Outcome::Stopped;
        case wire::JobOutcome::NoNodes:
            return Outcome::NoNodes;
        case wire::JobOutcome::Failed:
            break;
    }
    return Outcome::Failed;
}

const char* name(wire::NodePhase phase) {
    switch (phase) {
        case wire::NodePhase::Idle:
            return "idle";
        case wire::NodePhase::Syncing:
            return "syncing";
        case wire::NodePhase::Building:
            return "building";
        case wire::NodePhase::Rendering:
            return "rendering";
        case wire::NodePhase::Leaving:
            break;
    }
    return "leaving";
}

}  // namespace

wire::StartJob to_wire(const JobRequest& request, JobId job) {
    return {.job = job,
            .view = request.view,
            .spp = request.spp,
            .time_limit = request.time_limit,
            .policy = to_wire(request.policy),
            .reproducible = request.reproducible,
            .wait_nodes = request.wait_nodes,
            .wait_limit = request.wait_limit,
            .picture = static_cast<wire::PictureEncoding>(request.picture),
            .film = request.film,
            .budget = request.budget,
            .adapts_size = request.adapts_size};
}

Progress from_wire(const wire::JobProgress& progress) {
    return {.phase = from_wire(progress.phase),
            .samples = progress.samples,
            .samples_expected = progress.samples_expected,
            .rays = progress.rays,
            .nodes = progress.nodes,
            .elapsed = progress.elapsed};
}

JobResult from_wire(const wire::JobDone& done) {
    JobResult result{.outcome = from_wire(done.outcome),
                     .message = done.message,
                     .version = done.version,
                     .seconds_render = done.seconds_render,
                     .first_picture_seconds = done.first_picture_seconds,
                     .rays = done.rays,
                     .samples = done.samples,
                     .nonfinite_samples = done.nonfinite_samples,
                     .triangles = done.triangles,
                     .instances = done.instances,
                     .lights = done.lights,
                     .units = from_wire(done.units),
                     .wire_bytes = from_wire(done.wire_bytes)};
    result.samples_least = done.samples_least;
    result.samples_most = done.samples_most;
    if (const wire::PictureSummary& made = done.picture; made.encoding != wire::PictureEncoding::None) {
        Picture picture{.encoding = static_cast<PictureEncoding>(made.encoding),
                        .width = made.width,
                        .height = made.height,
                        .components = made.components,
                        .filter = made.filter,
                        .scale = made.scale,
                        .seconds_filter = made.seconds_filter,
                        .seconds_encode = made.seconds_encode,
                        .seconds_predicted = made.seconds_predicted,
                        .notes = made.notes};
        for (const wire::FilterPass& pass : made.passes) {
            picture.passes.push_back({pass.name, pass.seconds, pass.bytes_per_pixel});
        }
        result.picture = std::move(picture);
    }
    for (const wire::NodeSummary& node : done.nodes) result.nodes.push_back(from_wire(node));
    return result;
}

ClusterStatus from_wire(const wire::StatusReply& reply) {
    ClusterStatus status{.software = reply.software,
                         .version = reply.version,
                         .uptime_seconds = reply.uptime_seconds,
                         .blobs = reply.blobs,
                         .blob_bytes = reply.blob_bytes,
                         .sessions = reply.sessions,
                         .queued = reply.queued,
                         .dropped_messages = reply.dropped_messages,
                         .units = from_wire(reply.units),
                         .wire_bytes = from_wire(reply.wire_bytes),
                         .nodes = {},
                         .live = reply.live,
                         .resyncs = reply.resyncs,
                         .display = reply.display};
    for (const wire::NodeStatus& node : reply.nodes) {
        status.nodes.push_back({.share = from_wire(node.summary),
                                .phase = name(node.phase),
                                .version = node.version,
                                .units_in_hand = node.units_in_hand,
                                .samples_per_second = node.samples_per_second,
                                .round_trip_seconds = node.round_trip_seconds,
                                .stuck = node.stuck,
                                .clock_offset_seconds = node.clock_offset_seconds,
                                .clock_bound_seconds = node.clock_bound_seconds});
    }
    return status;
}

}  // namespace tessera::client
