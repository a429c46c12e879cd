#include "master/scene/scene_distributor.h"

#include "mediator/wire/envelope.h"

namespace tessera::master {

void SceneDistributor::published(NodeTable& nodes, const std::shared_ptr<const scene::ChangeList>& changes,
                                 TimePoint now) {
    // A node that was not sent the version before awaits a snapshot, or will get one by repair().
    const auto follows = [&](const NodeRecord& node) { return node.sent == changes->from; };
    if (changes->entries.size() > SceneEncoder::ShortList) {
        for (auto& [id, node] : nodes.all()) {
            if (follows(node))
                await_changes(
                    node, changes->from, changes->to, [changes] { return *changes; }, now);
        }
        return;
    }
    net::Bytes message = wire::encode(wire::ControlMessage(wire::Changes{*changes}));
    if (!wire::fits_control(message)) {
        long_changes_ = blobs_.insert(wire::encode(*changes));
        message = wire::encode(wire::ControlMessage(
            wire::ChangesByBlob{changes->from, changes->to, scene::reference(*long_changes_)}));
    }
    for (auto& [id, node] : nodes.all()) {
        if (!follows(node)) continue;
        outbox_.control(node.control, net::Bytes(message));
        node.sent = changes->to;
        node.sent_at = now;
        node.hash_mismatches = 0;
    }
}

void SceneDistributor::send_snapshot(NodeRecord& node, TimePoint now) {
    const Version version = scene_.version();
    const bool is_current = snapshot_ && snapshot_version_ == version && blobs_.find(snapshot_->hash());
    if (!is_current && scene_.scene().objects().size() > SceneEncoder::ShortList) {
        if (snapshot_job_ == 0) {
            snapshot_job_ = encoder_.encode({version.epoch, 0}, version,
                                            [scene = scene_.scene()] { return scene::snapshot(scene); });
        }
        node.awaits = snapshot_job_;
        node.sent = {};
        node.sent_at = now;
        return;
    }
    if (!is_current) {
        snapshot_ = blobs_.insert(wire::encode(scene_.snapshot()));
        snapshot_version_ = version;
    }
    if (node.sent != version) node.hash_mismatches = 0;
    send_blob(node, {version.epoch, 0}, version, snapshot_, now);
}

void SceneDistributor::send_blob(NodeRecord& node, Version from, Version to, const scene::BlobPtr& blob,
                                 TimePoint now) {
    outbox_.control(node.control, wire::ChangesByBlob{from, to, scene::reference(*blob)});
    node.awaits = 0;
    node.sent = to;
    node.sent_at = now;
}

// The list is encoded once for all nodes that await the same.
void SceneDistributor::await_changes(NodeRecord& node, Version from, Version to,
                                     std::function<scene::ChangeList()> make, TimePoint now) {
    if (changes_job_ == 0 || changes_from_ != from || changes_to_ != to) {
        changes_job_ = encoder_.encode(from, to, std::move(make));
        changes_from_ = from;
        changes_to_ = to;
    }
    node.awaits = changes_job_;
    node.sent = {};
    node.sent_at = now;
}

// Versions were published while the one that it was sent was being encoded.
void SceneDistributor::catch_up(NodeRecord& node, TimePoint now) {
    if (node.sent == scene_.version()) return;
    const auto missed = scene_.since(node.sent);
    if (!missed) return send_snapshot(node, now);
    const auto make = [missed] { return missed->list(); };
    if (missed->max_size() > SceneEncoder::ShortList)
        return await_changes(node, node.sent, scene_.version(), make, now);
    const net::Bytes message = wire::encode(wire::ControlMessage(wire::Changes{missed->list()}));
    if (!wire::fits_control(message)) return await_changes(node, node.sent, scene_.version(), make, now);
    outbox_.control(node.control, net::Bytes(message));
    node.sent = scene_.version();
    node.hash_mismatches = 0;
}

void SceneDistributor::take(const EncodedScene& made, NodeTable& nodes, TimePoint now) {
    const bool is_snapshot = made.job == snapshot_job_;
    if (is_snapshot) snapshot_job_ = 0;
    if (made.job == changes_job_) changes_job_ = 0;
    const bool is_usable = made.blob && made.to.epoch == scene_.version().epoch;
    scene::BlobPtr blob;
    for (auto& [id, node] : nodes.all()) {
        if (node.awaits != made.job) continue;
        node.awaits = 0;
        if (!is_usable) continue;  // repair() tries again
        if (!blob) blob = blobs_.insert(made.blob);
        send_blob(node, made.from, made.to, blob, now);
        catch_up(node, now);
    }
    if (!blob) return;
    if (is_snapshot) {
        snapshot_ = blob;
        snapshot_version_ = made.to;
    } else {
        long_changes_ = blob;
    }
}

void SceneDistributor::resync(NodeRecord& node, const wire::Resync& request, TimePoint now) {
    ++resyncs_;
    events_({wire::Severity::Warning,
             "node " + node.hello.name + " requests a snapshot: " + request.reason,
             {.node = node.hello.name}});
    send_snapshot(node, now);
}

SceneDistributor::CheckResult SceneDistributor::reported(NodeRecord& node, const wire::VersionReport& report,
                                                         TimePoint now) {
    if (report.version != scene_.version()) return CheckResult::Behind;
    if (report.state_hash == scene_.state_hash()) {
        node.reported = report.version;
        return CheckResult::Good;
    }
    ++resyncs_;
    if (++node.hash_mismatches > 1) {
        events_({wire::Severity::Error,
                 "node " + node.hello.name + " disagrees with the master about the scene at version " +
                     std::to_string(report.version.number) +
                     " for the second time: the node is removed; check its build",
                 {.node = node.hello.name, .version = report.version}});
        return CheckResult::RemoveNode;
    }
    send_snapshot(node, now);
    return CheckResult::Behind;
}

void SceneDistributor::refused(NodeRecord& node, const wire::SceneRefused& refusal) {
    if (refusal.version != scene_.version()) return;
    node.refused = refusal.version;
    node.refusal = refusal.reason;
    events_({wire::Severity::Warning,
             "node " + node.hello.name + " cannot build version " + std::to_string(refusal.version.number) +
                 ": " + refusal.reason,
             {.node = node.hello.name, .version = refusal.version}});
}

void SceneDistributor::repair(NodeTable& nodes, TimePoint now, Duration timeout) {
    for (auto& [id, node] : nodes.all()) {
        const bool busy = node.state.phase == session::NodePhase::Syncing ||
                          node.state.phase == session::NodePhase::Building || node.leaving ||
                          node.awaits != 0;
        const bool settled = node.reported == scene_.version() || node.refused == scene_.version();
        if (settled || busy || now - node.sent_at < timeout) continue;
        ++resyncs_;
        send_snapshot(node, now);
    }
}

}  // namespace tessera::master
