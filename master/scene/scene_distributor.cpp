#include "master/scene/scene_distributor.h"

#include "mediator/wire/envelope.h"

namespace tessera::master {

void SceneDistributor::published(NodeTable& nodes, const scene::ChangeList& changes, TimePoint now) {
    net::Bytes message;
    if (wire::may_fit_control(changes.entries.size()))
        message = wire::encode(wire::ControlMessage(wire::Changes{changes}));
    if (message.empty() || !wire::fits_control(message)) {
        long_changes_ = blobs_.insert(wire::encode(changes));
        message = wire::encode(wire::ControlMessage(
            wire::ChangesByBlob{changes.from, changes.to, scene::reference(*long_changes_)}));
    }
    for (auto& [id, node] : nodes.all()) {
        if (node.sent != changes.from) continue;  // it is being sent a snapshot, or will be by repair()
        outbox_.control(node.control, net::Bytes(message));
        node.sent = changes.to;
        node.sent_at = now;
        node.hash_mismatches = 0;
    }
}

void SceneDistributor::send_snapshot(NodeRecord& node, TimePoint now) {
    if (!snapshot_ || snapshot_version_ != authority_.version() || !blobs_.find(snapshot_->hash())) {
        snapshot_ = blobs_.insert(wire::encode(authority_.snapshot()));
        snapshot_version_ = authority_.version();
    }
    const Version version = authority_.version();
    outbox_.control(node.control,
                    wire::ChangesByBlob{{version.epoch, 0}, version, scene::reference(*snapshot_)});
    if (node.sent != version) node.hash_mismatches = 0;
    node.sent = version;
    node.sent_at = now;
}

void SceneDistributor::resync(NodeRecord& node, const wire::Resync& request, TimePoint now) {
    ++resyncs_;
    events_({wire::Severity::Warning, "node " + node.hello.name + " requests a snapshot: " + request.reason});
    send_snapshot(node, now);
}

SceneDistributor::CheckResult SceneDistributor::reported(NodeRecord& node, const wire::VersionReport& report,
                                                         TimePoint now) {
    if (report.version != authority_.version()) return CheckResult::Behind;
    if (report.state_hash == authority_.state_hash()) {
        node.reported = report.version;
        return CheckResult::Good;
    }
    ++resyncs_;
    if (++node.hash_mismatches > 1) {
        events_({wire::Severity::Error, "node " + node.hello.name +
                                            " disagrees with the master about the scene at version " +
                                            std::to_string(report.version.number) +
                                            " for the second time: the node is removed; check its build"});
        return CheckResult::RemoveNode;
    }
    send_snapshot(node, now);
    return CheckResult::Behind;
}

void SceneDistributor::refused(NodeRecord& node, const wire::SceneRefused& refusal) {
    if (refusal.version != authority_.version()) return;
    node.refused = refusal.version;
    node.refusal = refusal.reason;
    events_({wire::Severity::Warning, "node " + node.hello.name + " cannot build version " +
                                          std::to_string(refusal.version.number) + ": " + refusal.reason});
}

void SceneDistributor::repair(NodeTable& nodes, TimePoint now, Duration timeout) {
    for (auto& [id, node] : nodes.all()) {
        const bool busy = node.state.phase == session::NodePhase::Syncing ||
                          node.state.phase == session::NodePhase::Building || node.leaving;
        const bool settled = node.reported == authority_.version() || node.refused == authority_.version();
        if (settled || busy || now - node.sent_at < timeout) continue;
        ++resyncs_;
        send_snapshot(node, now);
    }
}

}  // namespace tessera::master
