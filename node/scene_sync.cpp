#include "node/scene_sync.h"

#include <algorithm>

namespace tessera::node {

namespace {

constexpr std::size_t MaxReportedTexts = 64;  // of problems, so that a report fits the control link
constexpr std::size_t MaxTextLength = 400;
constexpr Duration FetchPause = std::chrono::milliseconds(100);  // between checks for due requests

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

SceneSync::SceneSync(const NodeSettings& settings, std::shared_ptr<scene::BlobStore> blobs, Effects& effects)
    : has_cache_(settings.cache.has_value()),
      blobs_(blobs),
      effects_(effects),
      replica_(blobs),
      fetcher_(blobs, settings.blob_limits),
      heartbeat_interval_(settings.liveness.interval) {}

void SceneSync::welcomed(std::uint64_t epoch, Duration heartbeat_interval) {
    if (epoch != epoch_) {
        fetcher_.forget_all();
        wanted_.clear();
        failed_at_ = {};
    }
    replica_.start_epoch(epoch);
    epoch_ = epoch;
    heartbeat_interval_ = heartbeat_interval;
    linked_ = true;
}

void SceneSync::changes(wire::Changes& changes, TimePoint now) {
    const Version from = changes.list.from, to = changes.list.to;
    on_checked(replica_.receive(std::move(changes.list)), from, to, now);
}

void SceneSync::changes(const wire::ChangesByBlob& changes, TimePoint now) {
    on_checked(replica_.receive(changes), changes.from, changes.to, now);
}

void SceneSync::on_checked(SceneReplica::CheckResult result, Version from, Version to, TimePoint now) {
    if (!linked_) return;
    switch (result) {
        case SceneReplica::CheckResult::Accepted:
            snapshot_retry_at_.reset();
            refused_.reset();
            if (from.number == 0) lists_received_.clear();  // a snapshot supersedes everything before it
            lists_received_.emplace_back(to, now);
            effects_.state_changed = true;
            break;
        case SceneReplica::CheckResult::Duplicate:
            if (!replica_.awaits_snapshot()) snapshot_retry_at_.reset();
            if (to == replica_.version()) send_version_report();  // the last one may have been lost
            break;
        case SceneReplica::CheckResult::Gap:
            if (refused_ && to != *refused_) {
                refused_.reset();
                ask_for_snapshot("version " + std::to_string(to.number) + " may be possible", now);
            } else if (!replica_.awaits_snapshot()) {
                ask_for_snapshot(to.epoch != epoch_
                                     ? "a change list of another epoch"
                                     : "a change list is missing before version " + std::to_string(to.number),
                                 now);
            }
            break;
    }
}

// When the first of the lists that were built together was received.
std::int64_t SceneSync::received_at(Version to) {
    std::int64_t first = 0;
    while (!lists_received_.empty() && lists_received_.front().first <= to) {
        const auto& [version, when] = lists_received_.front();
        if (first == 0 && version.epoch == to.epoch) first = when.time_since_epoch().count();
        lists_received_.pop_front();
    }
    return first;
}

void SceneSync::ask_for_snapshot(const std::string& reason, TimePoint now) {
    replica_.await_snapshot();
    ++effects_.counters.resyncs;
    effects_.state_changed = true;
    snapshot_retry_at_ = now + 3 * heartbeat_interval_;
    effects_.send(wire::Resync{replica_.version(), reason});
}

// A list may have been damaged, which a snapshot repairs. If that is no better, master and node disagree.
void SceneSync::not_applied(const std::string& reason, Version at, TimePoint now) {
    if (failed_at_ == at) return refuse(reason + "; check that master and node are the same build", at);
    failed_at_ = at;
    effects_.report(wire::Severity::Warning,
                    "version " + std::to_string(at.number) + " could not be applied: " + reason);
    ask_for_snapshot(reason, now);
}

// The next version may be possible; until it arrives no snapshot is requested.
void SceneSync::refuse(const std::string& reason, Version at) {
    refused_ = at;
    effects_.report(wire::Severity::Warning, "version " + std::to_string(at.number) + ": " + reason +
                                                 "; this node waits for another version");
    effects_.send(wire::SceneRefused{at, reason.substr(0, MaxTextLength)});
}

bool SceneSync::advance(TimePoint now) {
    if (const Expected<void> done = replica_.advance(); !done)
        not_applied(done.error().what(), replica_.refused_version(), now);
    want(replica_.missing());
    std::optional<SceneReplica::Build> build = replica_.take_build();
    if (!build) return false;
    effects_.state_changed = true;
    effects_.add(BuildScene{std::move(*build)});
    return true;
}

bool SceneSync::built(BuildOutcome&& built, TimePoint now) {
    effects_.state_changed = true;
    if (!built.report) {
        const Version at = replica_.announced();
        if (replica_.rejected()) refuse(built.report.error().what(), at);
        return false;
    }
    if (!replica_.built()) return false;
    const backend::EditReport& edit = *built.report;
    std::vector<std::string> problems = std::move(built.problems);
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
    return true;
}

void SceneSync::send_version_report() {
    if (linked_ && replica_.version().number != 0) effects_.send(latest_report_);
}

void SceneSync::want(const std::vector<scene::BlobRef>& blobs) {
    std::vector<scene::BlobRef> unknown;
    for (const scene::BlobRef& blob : blobs) {
        if (wanted_.contains(blob.hash)) continue;
        if (has_cache_ && looked_up_.insert(blob.hash).second) {
            unknown.push_back(blob);
        } else if (!has_cache_ && wanted_.insert(blob.hash).second) {
            if (const Expected<void> taken = fetcher_.want(blob); !taken) {
                effects_.send(wire::Notice{wire::Severity::Error, taken.error().what()});
                effects_.report(wire::Severity::Error, taken.error().what());
            }
        }
    }
    if (!unknown.empty()) effects_.add(LoadBlobs{std::move(unknown)});
}

void SceneSync::looked_up(const std::vector<scene::BlobRef>& blobs) {
    for (const scene::BlobRef& blob : blobs) {
        looked_up_.erase(blob.hash);
        if (blobs_->find(blob.hash) || !wanted_.insert(blob.hash).second) continue;
        if (const Expected<void> taken = fetcher_.want(blob); !taken)
            effects_.report(wire::Severity::Error, taken.error().what());
    }
}

bool SceneSync::chunk(wire::BlobChunk&& chunk, TimePoint now) {
    const Hash256 hash = chunk.hash;
    if (!wanted_.contains(hash)) return false;  // a duplicate reply to a repeated request
    if (const Expected<void> taken = fetcher_.receive(std::move(chunk), now); !taken) {
        effects_.malformed(taken.error().what());
        return false;
    }
    scene::BlobPtr blob = blobs_->find(hash);
    if (!blob) return false;
    wanted_.erase(hash);
    if (has_cache_) effects_.add(SaveBlob{std::move(blob)});
    return true;
}

void SceneSync::absent(const wire::BlobAbsent& absent, TimePoint now) {
    if (!wanted_.contains(absent.hash)) return;
    fetcher_.absent(absent.hash);
    // The master keeps long lists for the latest version only: asking again would not help.
    if (replica_.awaits_list(absent.hash)) {
        wanted_.erase(absent.hash);
        fetcher_.forget(absent.hash);
        replica_.discard();
        return ask_for_snapshot("a change list is no longer kept", now);
    }
    if (absent_retry_at_) return;
    effects_.report(wire::Severity::Warning,
                    "the master lacks blob " + to_hex(absent.hash) + "; asking again");
    absent_retry_at_ = now + heartbeat_interval_;
}

void SceneSync::keep_fetching(TimePoint now) {
    if (!linked_) return;
    if (absent_retry_at_ && now >= *absent_retry_at_) {
        absent_retry_at_.reset();
        for (const Hash256& hash : fetcher_.absent_blobs()) wanted_.erase(hash);
        want(replica_.missing());
    }
    if (replica_.awaits_snapshot() && snapshot_retry_at_ && now >= *snapshot_retry_at_) {
        ask_for_snapshot("still waiting for a snapshot", now);
    }
    for (const wire::BlobRequest& request : fetcher_.due(now)) effects_.add(SendBulk{request});
}

std::optional<TimePoint> SceneSync::next_event(TimePoint now) const {
    std::optional<TimePoint> next = snapshot_retry_at_;
    const auto sooner = [&](TimePoint at) { next = next ? std::min(*next, at) : at; };
    if (absent_retry_at_) sooner(*absent_retry_at_);
    if (!fetcher_.idle()) sooner(now + FetchPause);
    return next;
}

}  // namespace tessera::node
