#pragma once

#include <deque>
#include <optional>
#include <set>
#include <string>

#include "mediator/wire/blob_transfer.h"
#include "node/actions.h"

namespace tessera::node {

// The result of a build.
struct BuildOutcome {
    Expected<backend::EditReport> report = backend::EditReport{};
    std::vector<std::string> problems;  // found while validating received blobs
};

// Keeps the scene in sync with the master's: checks change lists, fetches their blobs, has the back-end build complete
// lists, and reports the built version. A version that cannot be built is refused with the reason: the node keeps the one
// before and waits for the next. Pure; single-threaded.
class SceneSync {
  public:
    SceneSync(const NodeSettings& settings, std::shared_ptr<scene::BlobStore> blobs, Effects& effects);

    void welcomed(std::uint64_t epoch, Duration heartbeat_interval);
    void link_lost() { linked_ = false; }

    void changes(wire::Changes& changes, TimePoint now);
    void changes(const wire::ChangesByBlob& changes, TimePoint now);
    bool chunk(wire::BlobChunk&& chunk, TimePoint now);  // true: a blob is complete
    void absent(const wire::BlobAbsent& absent, TimePoint now);
    void looked_up(const std::vector<scene::BlobRef>& blobs);  // in the cache
    // True: waiting units have to be rechecked, since the built version has changed.
    bool built(BuildOutcome&& built, TimePoint now);
    // Advances the replica. True: a build has begun, so no more units of the current version may start.
    bool advance(TimePoint now);
    void keep_fetching(TimePoint now);

    const SceneReplica& replica() const { return replica_; }
    std::uint64_t received_bytes() const { return fetcher_.received_bytes(); }  // of blobs, since the start
    std::optional<TimePoint> next_event(TimePoint now) const;

  private:
    void on_checked(SceneReplica::CheckResult result, Version from, Version to, TimePoint now);
    std::int64_t received_at(Version to);  // and forgets the lists up to `to`
    void not_applied(const std::string& reason, Version at, TimePoint now);
    void refuse(const std::string& reason, Version at);
    void ask_for_snapshot(const std::string& reason, TimePoint now);
    void send_version_report();
    void want(const std::vector<scene::BlobRef>& blobs);

    bool has_cache_;
    std::shared_ptr<scene::BlobStore> blobs_;
    Effects& effects_;
    SceneReplica replica_;
    wire::BlobFetcher fetcher_;

    bool linked_ = false;
    std::uint64_t epoch_ = 0;
    Duration heartbeat_interval_;
    std::set<Hash256> wanted_, looked_up_;
    std::optional<TimePoint> snapshot_retry_at_, absent_retry_at_;
    Version failed_at_;               // the version that could not be applied last
    std::optional<Version> refused_;  // the back-end cannot build it, or it does not match its hash
    std::deque<std::pair<Version, TimePoint>>
        lists_received_;  // versions of lists that are not built, and when they arrived
    wire::VersionReport latest_report_;
};

}  // namespace tessera::node
