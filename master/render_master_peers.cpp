// Control messages of nodes and clients, and their removal.
#include <algorithm>

#include "master/render_master.h"
#include "mediator/wire/peer_texts.h"

namespace tessera::master {

void RenderMaster::from_node(NodeRecord& node, wire::ControlMessage& message, TimePoint now) {
    wire::shorten_texts(message);
    if (const auto* beat = std::get_if<wire::Heartbeat>(&message)) {
        nodes_.heartbeat(node, *beat, now);
    } else if (const auto* report = std::get_if<wire::VersionReport>(&message)) {
        switch (scene_.distributor().reported(node, *report, now)) {
            case SceneDistributor::CheckResult::Good:
                scene_.views().scene_facts({report->triangles, report->instances, report->lights});
                scene_.node_built(node, *report, now);
                for (const std::string& problem : report->problems)
                    events_({wire::Severity::Warning, problem});
                break;
            case SceneDistributor::CheckResult::Behind:
                break;
            case SceneDistributor::CheckResult::RemoveNode:
                outbox_.control(node.control,
                                wire::Refusal{"your scene differs from the master's: check the build"});
                return remove_node(node.id, "its scene differs from the master's",
                                   Dispatcher::Departure::Expected, now);
        }
    } else if (const auto* resync = std::get_if<wire::Resync>(&message)) {
        scene_.distributor().resync(node, *resync, now);
    } else if (const auto* refused = std::get_if<wire::SceneRefused>(&message)) {
        scene_.node_refused(node, *refused, now);
    } else if (const auto* release = std::get_if<wire::UnitReleased>(&message)) {
        dispatcher_.released(node, *release, now);
    } else if (const auto* notice = std::get_if<wire::Notice>(&message)) {
        events_(
            {notice->severity, "node " + node.hello.name + ": " + notice->text, {.node = node.hello.name}});
    } else if (const auto* goodbye = std::get_if<wire::Goodbye>(&message)) {
        dispatcher_.goodbye(node, *goodbye);
        node.leaving = true;  // stays in the table until its timeout, since film may still arrive
        events_({wire::Severity::Info,
                 "node " + node.hello.name + " leaves: " + goodbye->reason,
                 {.node = node.hello.name}});
    }
}

bool RenderMaster::must_wait(const SessionRecord& session, const wire::ControlMessage& message) const {
    if (session.held.empty()) return scene_.waits(session, message);
    return !std::holds_alternative<wire::Heartbeat>(message);  // in order
}

void RenderMaster::hold(SessionRecord& session, const net::Message& message, wire::ControlMessage&& decoded) {
    constexpr std::size_t MaxMessages = 1024, MaxBytes = std::size_t{16} << 20;
    if (session.held.size() >= MaxMessages || session.held_bytes >= MaxBytes)
        return drop(message, "too many messages of this client wait for an edit");
    session.held_bytes += message.bytes.size();
    session.held.push_back({std::move(decoded), message.bytes.size()});
}

void RenderMaster::serve_held_messages(TimePoint now) {
    std::vector<SessionId> holding;
    for (const auto& [id, session] : sessions_.all()) {
        if (!session.held.empty()) holding.push_back(id);
    }
    for (const SessionId id : holding) {
        // A message may end its session.
        for (SessionRecord* session = sessions_.find(id);
             session && !session->held.empty() && !scene_.waits(*session, session->held.front().message);
             session = sessions_.find(id)) {
            SessionRecord::HeldMessage held = std::move(session->held.front());
            session->held.pop_front();
            session->held_bytes -= held.byte_size;
            guard_.run(wire::table::Control::name(held.message),
                       [&] { from_client(*session, held.message, held.byte_size, now); });
        }
    }
}

void RenderMaster::from_client(SessionRecord& session, wire::ControlMessage& message, std::size_t byte_size,
                               TimePoint now) {
    if (const auto* beat = std::get_if<wire::Heartbeat>(&message)) {
        session.heartbeat_sent_at = beat->sent_at;
        session.heartbeat_at = now;
        session.clock.heartbeat(beat->sent_at, beat->echo_sent_at, beat->echo_delay, now);
    } else if (auto* edit = std::get_if<wire::SubmitEdit>(&message)) {
        service_.submit(session, std::move(edit->edit), byte_size, now);
    } else if (const auto* long_edit = std::get_if<wire::SubmitEditByBlob>(&message)) {
        service_.submit(session, *long_edit, now);
    } else if (const auto* set = std::get_if<wire::SetViewFilter>(&message)) {
        scene_.handle(session, *set, now);
    } else if (const auto* jobs = std::get_if<wire::ReadJobs>(&message)) {
        scene_.handle(session, *jobs, now);
    } else if (const auto* fetched = std::get_if<wire::FetchJob>(&message)) {
        scene_.handle(session, *fetched);
    } else if (const auto* cancelled = std::get_if<wire::CancelJob>(&message)) {
        scene_.handle(session, *cancelled, now);
    } else if (const auto* asked = std::get_if<wire::StatusRequest>(&message)) {
        outbox_.control(session.control, status_page(asked->after, now));
    } else if (const auto* join = std::get_if<wire::JoinScene>(&message)) {
        service_.join_scene(session, *join, now);
    } else if (std::holds_alternative<wire::Goodbye>(message)) {
        remove_session(session.id, Views::DisconnectReason::Graceful, now);
    } else if (const auto* order = std::get_if<wire::ManageNode>(&message)) {
        manage_node(session, *order, now);
    } else if (const auto* traced = std::get_if<wire::ReadTrace>(&message)) {
        outbox_.control(session.control, scene_.trace(*traced));
    } else if (scene_.is_member(session.id)) {
        from_member(session, message, now);
    } else {
        outbox_.control(session.control, wire::Refusal{"this client has not joined a scene: join one first"});
    }
}

void RenderMaster::manage_node(const SessionRecord& session, const wire::ManageNode& order, TimePoint now) {
    wire::RequestDone done{.request = order.request, .accepted = true, .text = {}};
    if (order.order == wire::ManageNode::Order::Release) {
        done.accepted = dispatcher_.release_from_quarantine(order.name, now);
        if (!done.accepted) done.text = "no node named '" + order.name + "' is in quarantine";
    } else {
        std::size_t count = 0;
        for (const auto& [id, node] : nodes_.all()) {
            if (node.hello.name != order.name) continue;
            outbox_.control(node.control, wire::Leave{});
            ++count;
        }
        done.accepted = count > 0;
        if (count == 0) done.text = "there is no node named '" + order.name + "': tessera status lists them";
    }
    if (done.accepted) {
        events_({wire::Severity::Info, session.user + " ordered node " + order.name + ": " +
                                           std::string(enumerator_name(order.order))});
    }
    outbox_.control(session.control, std::move(done));
}

void RenderMaster::from_member(SessionRecord& session, wire::ControlMessage& message, TimePoint now) {
    if (const auto* view = std::get_if<wire::RequestView>(&message)) {
        service_.request_view(session, *view, now);
    } else if (const auto* ended = std::get_if<wire::EndView>(&message)) {
        service_.end_view(session, *ended, now);
    } else if (const auto* taken = std::get_if<wire::FrameTaken>(&message)) {
        scene_.views().taken(session.id, *taken);
    } else if (const auto* pick = std::get_if<wire::Pick>(&message)) {
        scene_.views().pick(session.id, *pick, scene_.published().version());
    } else if (const auto* read = std::get_if<wire::ReadScene>(&message)) {
        scene_.handle(session, *read);
    } else if (const auto* lock = std::get_if<wire::LockObjects>(&message)) {
        scene_.handle(session, *lock);
    } else if (auto* presence = std::get_if<wire::SetPresence>(&message)) {
        scene_.handle(session, std::move(*presence), now);
    } else if (const auto* members = std::get_if<wire::ReadMembers>(&message)) {
        scene_.handle(session, *members, now);
    } else if (const auto* history = std::get_if<wire::ReadHistory>(&message)) {
        scene_.handle(session, *history);
    } else if (const auto* writers = std::get_if<wire::ReadWriters>(&message)) {
        scene_.handle(session, *writers);
    } else if (const auto* end = std::get_if<wire::CloseScene>(&message)) {
        service_.close_scene(session, *end, now);
    } else if (const auto* ready = std::get_if<wire::OutputReady>(&message)) {
        scene_.display().ready(session.id, *ready, now);
    } else if (const auto* head = std::get_if<wire::MoveHead>(&message)) {
        scene_.display().move_head(head->head);
    } else if (const auto* output = std::get_if<wire::JoinOutput>(&message)) {
        scene_.handle(session, *output, now);
    } else if (const auto* shown = std::get_if<wire::OpenDisplay>(&message)) {
        service_.open_display(session, *shown, now);
    } else if (const auto* hidden = std::get_if<wire::CloseDisplay>(&message)) {
        scene_.handle(session, *hidden);
    } else if (const auto* adjusted = std::get_if<wire::AdjustDisplay>(&message)) {
        scene_.handle(session, *adjusted);
    }
}

void RenderMaster::remove_node(NodeId id, const std::string& why, Dispatcher::Departure departure,
                               TimePoint now) {
    const NodeRecord* node = nodes_.find(id);
    if (node == nullptr) return;
    if (node->leaving) {
        departure = Dispatcher::Departure::Expected;
    } else {
        ++lost_nodes_;
        events_({wire::Severity::Warning,
                 "node " + node->hello.name + " is gone: " + why + dispatcher_.rendered_by(id),
                 {.node = node->hello.name}});
    }
    outbox_.forget(net::Link::Control, node->control);
    if (node->bulk) outbox_.forget(net::Link::Bulk, *node->bulk);
    dispatcher_.node_gone(id, departure, now);
    scene_.node_gone(id);
    nodes_.remove(id);
}

void RenderMaster::remove_session(SessionId id, Views::DisconnectReason reason, TimePoint now) {
    const SessionRecord* session = sessions_.find(id);
    if (session == nullptr) return;
    outbox_.forget(net::Link::Control, session->control);
    if (session->bulk) outbox_.forget(net::Link::Bulk, *session->bulk);
    if (reason == Views::DisconnectReason::Timeout) ++lost_sessions_;
    service_.closed(id, reason, now);
}

void RenderMaster::remove_timed_out_peers(TimePoint now) {
    for (const NodeId id : nodes_.timed_out(now))
        remove_node(id, "silent for too long", Dispatcher::Departure::Silent, now);
    std::vector<SessionId> timed_out;
    for (const auto& [id, session] : sessions_.all()) {
        if (session.liveness.timed_out(now)) timed_out.push_back(id);
    }
    for (const SessionId id : timed_out) remove_session(id, Views::DisconnectReason::Timeout, now);
    if (!scene_.is_exclusive()) return;
    const std::vector<SessionId> not_reading = scene_.views().not_reading(now);
    if (sessions_.queue().empty()) return;  // no client waits
    for (const SessionId id : not_reading) {
        const SessionRecord* session = sessions_.find(id);
        if (session == nullptr) continue;
        events_({wire::Severity::Warning,
                 session->hello.name + " (" + session->user +
                     ") does not read its picture while others wait for its scene to end: it counts as lost",
                 {.session = session->id}});
        outbox_.control(session->control,
                        wire::Refusal{"you have not read your picture for too long while others waited for "
                                      "your scene to end: tessera jobs lists it"});
        remove_session(id, Views::DisconnectReason::Timeout, now);
    }
}

void RenderMaster::drop_lost_peers(TimePoint now) {
    for (const auto& [link, peer] : std::exchange(lost_, outbox_.take_lost())) {
        if (now < broken_until_) continue;  // they gave this master up, not the other way round
        const bool is_control = link == net::Link::Control;
        if (NodeRecord* node = is_control ? nodes_.by_control(peer) : nodes_.by_bulk(peer)) {
            remove_node(node->id, "its connection broke", Dispatcher::Departure::Ended, now);
        } else if (SessionRecord* session =
                       is_control ? sessions_.by_control(peer) : sessions_.by_bulk(peer)) {
            remove_session(session->id, Views::DisconnectReason::Timeout, now);
        }
    }
}

// As many nodes as fit.
net::Bytes RenderMaster::status_page(NodeId after, TimePoint now) const {
    wire::StatusReply reply{.status = status(now)};
    std::vector<session::NodeStatus>& nodes = reply.status.nodes;
    std::erase_if(nodes, [&](const session::NodeStatus& node) { return node.summary.id <= after; });
    net::Bytes message = wire::encode(wire::ControlMessage(reply));
    while (!wire::fits_control(message) && !nodes.empty()) {
        nodes.resize(nodes.size() / 2);
        reply.more = true;
        message = wire::encode(wire::ControlMessage(reply));
    }
    return message;
}

session::ClusterStatus RenderMaster::status(TimePoint now) const {
    session::ClusterStatus reply{.software = settings_.software,
                                 .version = scene_.published().version(),
                                 .uptime_seconds = seconds(now - started_),
                                 .blobs = blobs_->count(),
                                 .blob_bytes = blobs_->byte_size(),
                                 .sessions = static_cast<std::uint32_t>(sessions_.all().size()),
                                 .queued = static_cast<std::uint32_t>(sessions_.queue().size()),
                                 .dropped_messages = dropped_messages_,
                                 .units = dispatcher_.counts(),
                                 .wire_bytes = outbox_.bytes,
                                 .scene = scene_.status(),
                                 .resyncs = scene_.distributor().resyncs(),
                                 .display = scene_.display().status(now),
                                 .contradictions = dispatcher_.contradictions(),
                                 .caught_exceptions = guard_.caught(),
                                 .loop = monitor_.status(),
                                 .verified_units = dispatcher_.verified_units(),
                                 .refused_film = dispatcher_.refused_film(),
                                 .lost_nodes = lost_nodes_,
                                 .lost_sessions = lost_sessions_};
    if (settings_.refused_traffic) {
        const net::RefusedTraffic refused = settings_.refused_traffic();
        reply.refused_handshakes = refused.handshakes;
        reply.dropped_messages += refused.messages;
    }
    for (const auto& [id, node] : nodes_.all()) {
        session::NodeStatus entry{
            .summary = {.id = id,
                        .name = node.hello.name,
                        .host = node.hello.host,
                        .backend = node.hello.backend,
                        .kind = node.hello.kind,
                        .pid = node.hello.pid},
            .phase = node.state.phase,
            .version = node.state.version,
            .units_in_flight = static_cast<std::uint32_t>(node.state.in_flight.size()),
            .samples_per_second = dispatcher_.rate(id) * std::max(1u, node.hello.concurrent_units),
            .round_trip_seconds = node.round_trip_seconds,
            .stuck = node.stuck,
            .quarantine = {},
            .idle_reason = dispatcher_.idle_reason(node),
            .film_bytes = node.film_taken,
            .scene_bytes = node.state.scene_bytes,
            .silent_seconds = node.heartbeat_at == TimePoint{} ? 0.0 : seconds(now - node.heartbeat_at),
            .units_waiting = static_cast<std::uint32_t>(node.pending.size()),
            .last_fault = {}};
        if (const auto* noted = dispatcher_.quarantine().faults(node.identity(), now)) {
            entry.faults = noted->faults;
            entry.last_fault = noted->reason;
        }
        if (const auto* held = dispatcher_.quarantine().find(node.identity(), now)) {
            entry.quarantine = held->reason;
            entry.quarantine_seconds = seconds(*held->until - now);
        }
        if (const auto clock = node.clock.offset(now)) {
            entry.clock_offset_seconds = seconds(clock->offset);
            entry.clock_bound_seconds = seconds(clock->bound);
        }
        reply.nodes.push_back(std::move(entry));
    }
    return reply;
}

}  // namespace tessera::master
