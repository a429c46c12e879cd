#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>

#include "mediator/base/error.h"
#include "mediator/scene/blob.h"

namespace tessera::master {

// The blobs in a session folder. The journal writes those of an edit before the edit; the checkpoint writer removes
// those that neither the last two checkpoints nor the journal since the older of them refer to. Thread-safe.
class StoredBlobs {
  public:
    // `blobs`: those in memory.
    StoredBlobs(std::filesystem::path session_folder, std::shared_ptr<const scene::BlobStore> blobs);

    // An edit that will be recorded in that segment refers to the blob. True: this process has written it, so it is on
    // disk and stays until a checkpoint after that segment.
    bool use(const Hash256& blob, std::uint64_t segment);
    // Writes a blob that use() was called for. Fails with Io.
    Expected<void> write(const scene::Blob& blob);
    // The disk did not take them: they may be lost, even if they can still be read.
    void sync_failed(const Hash256& blob);
    void sync_failed_of_all();
    // Of the blobs that a checkpoint is going to refer to, writes those again whose sync failed, and syncs them. Throws
    // Error{Io}, or Error{NotFound} for one that is no longer in memory.
    void write_lost_again(const std::set<Hash256>& referenced);
    void scene_closed();  // from now on each blob is looked for on disk again

    // The checkpoint of that number is on disk and refers to these blobs.
    void written(std::uint64_t checkpoint, std::set<Hash256>&& blobs);
    // Removes unused files; none unless both checkpoints in the folder were announced by written(), and the journal
    // before them is gone. Returns their number.
    std::size_t remove_unused();

  private:
    const std::filesystem::path folder_;
    const std::shared_ptr<const scene::BlobStore> blobs_;
    std::mutex mutex_;                       // protects all below
    std::map<Hash256, std::uint64_t> used_;  // in which segment, at last
    std::set<Hash256> kept_;                 // written, or found intact
    std::set<Hash256> lost_;                 // maybe: their sync failed
    std::map<std::uint64_t, std::set<Hash256>> checkpoints_;
};

}  // namespace tessera::master
