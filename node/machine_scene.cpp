// Keeping the scene: change lists, blobs, builds.
#include <algorithm>

#include "node/machine.h"

namespace tessera::node {

namespace {

constexpr std::size_t MaxReportedTexts = 64;  // of problems, so that a report fits the control link
constexpr std::size_t MaxTextLength = 400;

std::vector<std::string> trimmed(std::vector<std::string> texts) {
    const std::size_t count = texts.size();
    if (count > MaxReportedTexts) {
        texts.resize(MaxReportedTexts);
        texts.push_back("and " + std::to_string(count - MaxReportedTexts) + " more problems");
    }
    for (std::string& text : texts) text.resize(std::min(text.size(), MaxTextLength));
    return texts;
}

}  // namespace

void NodeMachine::on(wire::Changes& changes, TimePoint now) {
    const Version from = changes.list.from, to = changes.list.to;
    judged(replica_.offer(std::move(changes.list)), from, to, now);
}

void NodeMachine::on(wire::ChangesByBlob& changes, TimePoint now) {
    judged(replica_.offer(changes), changes.from, changes.to, now);
}

void NodeMachine::judged(SceneReplica::Verdict verdict, Version from, Version to, TimePoint now) {
    if (!welcomed_ || leaving_) return;
    switch (verdict) {
        case SceneReplica::Verdict::Accepted:
            snapshot_retry_at_.reset();
            too_large_.reset();
            if (from.number == 0) lists_received_.clear();  // nothing before a snapshot matters
            lists_received_.emplace_back(to, now);
            changed_ = true;
            step_scene(now);
            break;
        case SceneReplica::Verdict::Duplicate:
            if (!replica_.awaits_snapshot()) snapshot_retry_at_.reset();
            if (to == replica_.version()) send_version_report();  // the last one may have got lost
            break;
        case SceneReplica::Verdict::Gap:
            if (too_large_ && to != *too_large_) {
                too_large_.reset();
                ask_for_snapshot("version " + std::to_string(to.number) + " may fit", now);
            } else if (!replica_.awaits_snapshot()) {
                ask_for_snapshot(to.epoch != epoch_
                                     ? "a change list of another epoch"
                                     : "a change list is missing before version " + std::to_string(to.number),
                                 now);
            }
            break;
    }
}

// Of the first list of those that were built together.
std::int64_t NodeMachine::received_at(Version to) {
    std::int64_t first = 0;
    while (!lists_received_.empty() && lists_received_.front().first <= to) {
        const auto& [version, when] = lists_received_.front();
        if (first == 0 && version.epoch == to.epoch) first = when.time_since_epoch().count();
        lists_received_.pop_front();
    }
    return first;
}

void NodeMachine::ask_for_snapshot(const std::string& reason, TimePoint now) {
    replica_.await_snapshot();
    ++counters_.resyncs;
    changed_ = true;
    snapshot_retry_at_ = now + 3 * heartbeat_interval_;
    send(wire::Resync{replica_.version(), reason});
}

void NodeMachine::scene_failed(const std::string& reason, Version at, TimePoint now) {
    if (failed_at_ == at) {
        return fail("the scene went wrong twice at version " + std::to_string(at.number) + ": " + reason +
                    "; check that master and node are the same build");
    }
    failed_at_ = at;
    report(wire::Severity::Warning,
           "version " + std::to_string(at.number) + " could not be taken over: " + reason);
    ask_for_snapshot(reason, now);
}

// The back-end has kept its last version. The next one may be smaller: until it comes, there is nothing to
// ask for.
void NodeMachine::scene_too_large(const std::string& reason, Version at) {
    too_large_ = at;
    report(wire::Severity::Warning,
           "version " + std::to_string(at.number) + ": " + reason + "; this node waits for another version");
    send(wire::SceneRefused{at, reason});
}

void NodeMachine::step_scene(TimePoint now) {
    if (leaving_) return;
    if (const Expected<void> done = replica_.advance(); !done) {
        scene_failed(done.error().what(), replica_.refused_version(), now);
        if (left_) return;
    }
    want(replica_.missing());
    if (std::optional<SceneReplica::Build> build = replica_.take_build()) {
        changed_ = true;
        actions_.emplace_back(BuildScene{std::move(*build)});
        for (const view::WorkUnit& unit : queue_.waiting()) {
            if (unit.version == replica_.version()) {
                release(unit.id, wire::ReleaseReason::OtherVersion, "the node goes on to another version");
            }
        }
    }
}

void NodeMachine::built(BuildOutcome&& outcome, TimePoint now) {
    if (left_) return;
    changed_ = true;
    if (!outcome.report) {
        const Version at = replica_.announced();
        if (outcome.report.error().code() == ErrorCode::OutOfMemory) {
            if (!replica_.declined()) return step_scene(now);
            return scene_too_large(outcome.report.error().what(), at);
        }
        if (!replica_.failed()) return step_scene(now);
        return scene_failed("the back-end failed: " + std::string(outcome.report.error().what()), at, now);
    }
    if (!replica_.built()) return step_scene(now);
    const backend::EditReport& edit = *outcome.report;
    std::vector<std::string> problems = std::move(outcome.problems);
    for (const std::string& problem : edit.problems) {
        if (std::find(problems.begin(), problems.end(), problem) == problems.end())
            problems.push_back(problem);
    }
    latest_report_ = {.version = replica_.version(),
                      .state_hash = replica_.state_hash(),
                      .triangles = edit.triangles,
                      .instances = edit.instances,
                      .lights = edit.lights,
                      .degenerate_triangles = edit.degenerate_triangles,
                      .entries = edit.entries,
                      .relevant = edit.relevant,
                      .rebuilt = edit.rebuilt,
                      .refitted = edit.refitted,
                      .retransformed = edit.retransformed,
                      .ignored_kinds = trimmed(edit.ignored_kinds),
                      .problems = trimmed(std::move(problems)),
                      .received_at = received_at(replica_.version()),
                      .built_at = now.time_since_epoch().count()};
    failed_at_ = {};
    send_version_report();
    for (const view::WorkUnit& unit : queue_.waiting()) {
        if (const auto why = objection(unit)) release(unit.id, why->first, why->second);
    }
    step_scene(now);
}

void NodeMachine::send_version_report() {
    if (welcomed_ && replica_.version().number != 0) send(latest_report_);
}

void NodeMachine::want(const std::vector<scene::BlobRef>& blobs) {
    std::vector<scene::BlobRef> unknown;
    for (const scene::BlobRef& blob : blobs) {
        if (wanted_.contains(blob.hash)) continue;
        if (settings_.cache && looked_up_.insert(blob.hash).second) {
            unknown.push_back(blob);
        } else if (!settings_.cache && wanted_.insert(blob.hash).second) {
            if (const Expected<void> taken = fetcher_.want(blob); !taken) {
                send(wire::Notice{wire::Severity::Error, taken.error().what()});
                report(wire::Severity::Error, taken.error().what());
            }
        }
    }
    if (!unknown.empty()) actions_.emplace_back(LoadBlobs{std::move(unknown)});
}

void NodeMachine::looked_up(const std::vector<scene::BlobRef>& blobs, TimePoint now) {
    for (const scene::BlobRef& blob : blobs) {
        looked_up_.erase(blob.hash);
        if (blobs_->find(blob.hash) || !wanted_.insert(blob.hash).second) continue;
        if (const Expected<void> taken = fetcher_.want(blob); !taken)
            report(wire::Severity::Error, taken.error().what());
    }
    if (!left_ && !leaving_) step_scene(now);
}

void NodeMachine::bulk(wire::BulkMessage&& message, TimePoint now) {
    if (left_) return;
    liveness_.heard(now);
    if (auto* chunk = std::get_if<wire::BlobChunk>(&message)) {
        const Hash256 hash = chunk->hash;
        if (!wanted_.contains(hash)) return;  // an answer to a question asked twice
        if (const Expected<void> taken = fetcher_.receive(std::move(*chunk), now); !taken) {
            return malformed(taken.error().what(), now);
        }
        if (scene::BlobPtr blob = blobs_->find(hash)) {
            wanted_.erase(hash);
            if (settings_.cache) actions_.emplace_back(SaveBlob{std::move(blob)});
            step_scene(now);
        }
    } else if (const auto* absent = std::get_if<wire::BlobAbsent>(&message)) {
        if (!wanted_.contains(absent->hash)) return;
        fetcher_.absent(absent->hash);
        if (!absent_retry_at_) {
            report(wire::Severity::Warning,
                   "the master lacks blob " + to_hex(absent->hash) + "; asking again");
            absent_retry_at_ = now + heartbeat_interval_;
        }
    } else {
        malformed("a bulk message that no master sends to a node", now);
    }
}

void NodeMachine::keep_fetching(TimePoint now) {
    if (!welcomed_) return;
    if (absent_retry_at_ && now >= *absent_retry_at_) {
        absent_retry_at_.reset();
        for (const Hash256& hash : fetcher_.absent_blobs()) wanted_.erase(hash);
        want(replica_.missing());
    }
    if (replica_.awaits_snapshot() && snapshot_retry_at_ && now >= *snapshot_retry_at_) {
        ask_for_snapshot("still waiting for a snapshot", now);
    }
    for (const wire::BlobRequest& request : fetcher_.due(now)) actions_.emplace_back(SendBulk{request});
}

}  // namespace tessera::node
