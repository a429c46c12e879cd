#pragma once

#include "master/peers/event.h"
#include "master/peers/node_table.h"
#include "master/peers/outbox.h"
#include "master/scene/scene_authority.h"

namespace tessera::master {

// Brings every node to the authority's version: the next change list where it follows on what the node was
// sent, else a snapshot. Repairs what got lost: a node that stays behind is sent a snapshot, a node whose
// state hash is wrong once too, a second time at the same version it is to be taken out.
class SceneDistributor {
  public:
    SceneDistributor(SceneAuthority& authority, scene::BlobStore& blobs, Outbox& outbox, EventSink events)
        : authority_(authority), blobs_(blobs), outbox_(outbox), events_(std::move(events)) {}

    void published(NodeTable& nodes, const scene::ChangeList& changes, TimePoint now);
    void joined(NodeRecord& node, TimePoint now) { send_snapshot(node, now); }
    void resync(NodeRecord& node, const wire::Resync& request, TimePoint now);

    enum class Verdict { Good, Behind, TakeOut };
    Verdict reported(NodeRecord& node, const wire::VersionReport& report, TimePoint now);

    void refused(NodeRecord& node, const wire::SceneRefused& refusal);

    // A node that neither reports nor builds `patience` after it was sent the present version is sent it
    // again.
    void repair(NodeTable& nodes, TimePoint now, Duration patience);

    std::uint64_t resyncs() const { return resyncs_; }

  private:
    void send_snapshot(NodeRecord& node, TimePoint now);

    SceneAuthority& authority_;
    scene::BlobStore& blobs_;
    Outbox& outbox_;
    EventSink events_;
    Version snapshot_version_;
    scene::BlobPtr snapshot_;  // held here, since the store alone may drop it
    scene::BlobPtr long_changes_;
    std::uint64_t resyncs_ = 0;
};

}  // namespace tessera::master
