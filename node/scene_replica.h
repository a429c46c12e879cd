#pragma once

#include <deque>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "mediator/scene/scene.h"
#include "mediator/wire/messages.h"

namespace tessera::node {

// The node's own copy of the scene and the way of change lists into the back-end. Every list passes four
// stations, in order: announced (it may still be a blob that has to come) -> applied here (state hash
// checked) -> all blobs it brought are in the store -> built by the back-end. A blob that a later list lets
// go of is needed no more: both lists are built together. Pure; one thread.
class SceneReplica {
  public:
    explicit SceneReplica(std::shared_ptr<scene::BlobStore> blobs) : blobs_(std::move(blobs)) {}

    void start_epoch(std::uint64_t epoch);  // forgets the scene unless the epoch is the same; blobs stay

    enum class Verdict {
        Accepted,
        Duplicate,  // the same epoch and not newer: harmless
        Gap,        // does not follow on what is here: resync() is due
    };
    Verdict offer(scene::ChangeList list);
    Verdict offer(const wire::ChangesByBlob& announced);

    // Takes what has arrived one station further. A list that cannot be read or applied, or leads to another
    // hash, throws away everything not built;
    // refused_version() tells where it led.
    Expected<void> advance();
    Version refused_version() const { return refused_; }

    // What has to be fetched for the lists that are here, as they end: each once.
    std::vector<scene::BlobRef> missing() const;

    // The lists that the back-end can be given now, handed out once, each with the scene that it makes.
    struct Step {
        scene::ChangeList list;
        scene::Scene after;
    };
    struct Build {
        std::vector<Step> steps;
        std::vector<ObjectId> unchecked;  // geometries and textures whose blobs were never looked into
        // Of the last step.
        const scene::Scene& scene() const { return steps.back().after; }
    };
    std::optional<Build> take_build();
    bool is_building() const { return building_; }
    bool built();     // the back-end is at the build's version now
    bool failed();    // nobody knows what it holds: nothing that was built counts, a snapshot is due.
    bool declined();  // it holds what it held, and that version will not do: the next snapshot may.
    // All: false when the build was of another epoch, so that its end means nothing.

    // Starts over from the next snapshot; lists that follow on the present version are gaps until then.
    void await_snapshot();
    bool awaits_snapshot() const { return awaits_snapshot_; }

    Version version() const { return built_; }  // of the back-end: committed with all blobs
    Hash128 state_hash() const { return built_hash_; }
    Version announced() const { return announced_; }  // where the lists lead that are on their way
    bool is_behind() const { return announced_ != built_ || awaits_snapshot_; }
    const scene::Scene& scene() const { return scene_; }

  private:
    struct Announced {
        Version from, to;
        std::variant<scene::ChangeList, scene::BlobRef> content;
    };
    struct Applied {
        Step step;
        // What the objects refer to that it touched, as it left them; nothing where it removed one.
        std::vector<std::pair<ObjectId, std::vector<scene::BlobRef>>> objects;
    };

    Verdict judge(Version from, Version to) const;
    Verdict announce(Announced item);
    Expected<void> apply(scene::ChangeList list);
    std::size_t buildable() const;
    void discard();
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
    bool scene_lost_ = false;  // scene_ is not at announced_: only a snapshot helps
};

}  // namespace tessera::node
