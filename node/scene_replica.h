#pragma once

#include <deque>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "mediator/scene/scene.h"
#include "mediator/wire/messages.h"

namespace tessera::node {

// The node's copy of the scene, and the pipeline of change lists into the back-end. Every list passes four stages in
// order: announced (it may be a blob that has not arrived) -> applied here (state hash checked) -> all its blobs are in
// the store -> built by the back-end. If a later list releases a blob that has not arrived, both lists are built
// together without it. Pure; single-threaded.
class SceneReplica {
  public:
    explicit SceneReplica(std::shared_ptr<scene::BlobStore> blobs) : blobs_(std::move(blobs)) {}

    void start_epoch(std::uint64_t epoch);  // resets the scene unless the epoch is the same; blobs stay

    enum class CheckResult {
        Accepted,
        Duplicate,  // the same epoch and not newer: harmless
        Gap,        // does not follow the current version: a resync is needed
    };
    CheckResult receive(scene::ChangeList list);
    CheckResult receive(const wire::ChangesByBlob& announced);

    // Moves lists that have arrived to the next stage. A list that cannot be decoded or applied, or whose state hash
    // differs, discards everything that is not built; refused_version() is its version.
    Expected<void> advance();
    Version refused_version() const { return refused_; }

    // Blobs to fetch for the announced and applied lists, each once.
    std::vector<scene::BlobRef> missing() const;

    bool awaits_list(
        const Hash256& blob) const;  // whether the blob is an announced list, not a mesh or texture

    // The lists that the back-end can build now, returned once, each with the scene after it.
    struct Step {
        scene::ChangeList list;
        scene::Scene after;
    };
    struct Build {
        std::vector<Step> steps;
        std::vector<ObjectId> unchecked;  // geometries and textures whose blobs were not validated yet
        // Of the last step.
        const scene::Scene& scene() const { return steps.back().after; }
    };
    std::optional<Build> take_build();
    bool is_building() const { return building_; }
    bool built();     // the back-end is at the build's version now
    bool rejected();  // the back-end kept its previous version; it may be able to build the next snapshot
    // Both return false if the build was of another epoch and its result is meaningless.

    // Waits for the next snapshot; lists that follow the current version are gaps until then.
    void await_snapshot();
    bool awaits_snapshot() const { return awaits_snapshot_; }
    // Discards all lists that are not built, since one of them cannot be fetched, and waits for a snapshot.
    void discard();

    Version version() const { return built_; }  // built by the back-end with all blobs
    Hash128 state_hash() const { return built_hash_; }
    Version announced() const { return announced_; }  // the version of the latest announced list
    bool is_behind() const { return announced_ != built_ || awaits_snapshot_; }
    const scene::Scene& scene() const { return scene_; }

  private:
    struct Announced {
        Version from, to;
        std::variant<scene::ChangeList, scene::BlobRef> content;
    };
    struct Applied {
        Step step;
        // The blobs that each touched object refers to after the list; none for removed objects.
        std::vector<std::pair<ObjectId, std::vector<scene::BlobRef>>> objects;
    };

    CheckResult check(Version from, Version to) const;
    CheckResult announce(Announced item);
    Expected<void> apply(scene::ChangeList list);
    std::size_t buildable() const;
    bool here(const scene::BlobRef& blob) const { return blob.empty() || blobs_->find(blob.hash) != nullptr; }

    std::shared_ptr<scene::BlobStore> blobs_;
    std::uint64_t epoch_ = 0;
    scene::Scene scene_;  // after every applied list
    Version announced_, built_, refused_;
    Hash128 built_hash_;
    std::deque<Announced> announced_lists_;
    std::deque<Applied> applied_lists_;
    std::optional<std::pair<Version, Hash128>> building_target_;
    bool building_ = false;
    bool awaits_snapshot_ = false;
    bool scene_lost_ = false;  // scene_ is not at announced_: a snapshot is needed
};

}  // namespace tessera::node
