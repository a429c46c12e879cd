#pragma once

#include <deque>
#include <optional>
#include <set>
#include <string>

#include "mediator/wire/blob_transfer.h"
#include "node/actions.h"

namespace tessera::node {

// How a build ended.
struct BuildOutcome {
    Expected<backend::EditReport> report = backend::EditReport{};
    std::vector<std::string> problems;  // of what the network brought
};

// Keeps the scene in step with the master's: judges change lists, fetches the blobs that they name, has the
// back-end build what is complete, and reports the version that it holds. Pure; one thread.
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
    // True: units are to be judged anew, since the version that they may run on is another one.
    bool built(BuildOutcome&& built, TimePoint now);
    // Takes what is here one station further. True: a build has begun, so the present version ends.
    bool advance(TimePoint now);
    void keep_fetching(TimePoint now);

    // Not empty: the scene went wrong twice at one version, and the node has to leave.
    const std::string& failure() const { return failure_; }
    const SceneReplica& replica() const { return replica_; }
    std::optional<TimePoint> next_event(TimePoint now) const;

  private:
    void judged(SceneReplica::Verdict verdict, Version from, Version to, TimePoint now);
    std::int64_t received_at(Version to);  // and forgets what led there
    void failed(const std::string& reason, Version at, TimePoint now);
    void too_large(const std::string& reason, Version at);
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
    Version failed_at_;                 // where the scene went wrong last
    std::optional<Version> too_large_;  // the device has no room for it
    std::deque<std::pair<Version, TimePoint>>
        lists_received_;  // where those lead that are not built, and when
    wire::VersionReport latest_report_;
    std::string failure_;
};

}  // namespace tessera::node
