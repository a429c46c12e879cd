#pragma once

#include <functional>

#include "master/peers/event.h"
#include "master/peers/node_table.h"
#include "master/peers/outbox.h"
#include "master/scene/published_scene.h"
#include "master/scene/scene_encoder.h"

namespace tessera::master {

// Keeps the nodes at the published version: sends the next change list if it follows the version last sent to the
// node, else a snapshot. Repairs losses: a node that falls behind is sent a snapshot, as is one whose state hash is
// wrong; one whose hash is wrong twice at the same version is to be removed.
class SceneDistributor {
  public:
    SceneDistributor(const PublishedScene& scene, SceneEncoder& encoder, scene::BlobStore& blobs,
                     Outbox& outbox, EventSink events)
        : scene_(scene), encoder_(encoder), blobs_(blobs), outbox_(outbox), events_(std::move(events)) {}

    void published(NodeTable& nodes, const std::shared_ptr<const scene::ChangeList>& changes, TimePoint now);
    void take(const EncodedScene& made, NodeTable& nodes, TimePoint now);
    void joined(NodeRecord& node, TimePoint now) { send_snapshot(node, now); }
    void resync(NodeRecord& node, const wire::Resync& request, TimePoint now);

    enum class CheckResult { Good, Behind, RemoveNode };
    CheckResult reported(NodeRecord& node, const wire::VersionReport& report, TimePoint now);

    void refused(NodeRecord& node, const wire::SceneRefused& refusal);

    // Sends the current version again to nodes that neither report nor build it `timeout` after it was sent.
    void repair(NodeTable& nodes, TimePoint now, Duration timeout);

    std::uint64_t resyncs() const { return resyncs_; }

  private:
    void send_snapshot(NodeRecord& node, TimePoint now);
    void send_blob(NodeRecord& node, Version from, Version to, const scene::BlobPtr& blob, TimePoint now);
    void await_changes(NodeRecord& node, Version from, Version to, std::function<scene::ChangeList()> make,
                       TimePoint now);
    void catch_up(NodeRecord& node, TimePoint now);

    const PublishedScene& scene_;
    SceneEncoder& encoder_;
    scene::BlobStore& blobs_;
    Outbox& outbox_;
    EventSink events_;
    Version snapshot_version_;
    scene::BlobPtr snapshot_;         // kept alive here: the store may drop it
    std::uint64_t snapshot_job_ = 0;  // encodes a snapshot; 0 = none
    scene::BlobPtr long_changes_;
    std::uint64_t changes_job_ = 0;  // encodes the changes from changes_from_ to changes_to_; 0 = none
    Version changes_from_, changes_to_;
    std::uint64_t resyncs_ = 0;
};

}  // namespace tessera::master
