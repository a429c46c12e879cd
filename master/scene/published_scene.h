#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "mediator/scene/scene.h"

namespace tessera::master {

// An object that a version changed.
struct TouchedObject {
    ObjectId id;
    scene::FieldMask mask = 0;             // the fields that may differ
    std::optional<scene::ObjectKind> was;  // its kind before the version; none: it did not exist
};
using TouchedObjects = std::shared_ptr<const std::vector<TouchedObject>>;

// What a reader of an earlier version lacks. The list itself is made when it is asked for, on any thread: it may be
// long.
class MissedChanges {
  public:
    MissedChanges(Version from, scene::Scene scene, std::vector<TouchedObjects> versions);
    std::size_t max_size() const { return size_; }  // entries at most
    scene::ChangeList list() const;

  private:
    Version from_;
    scene::Scene scene_;
    std::vector<TouchedObjects> versions_;
    std::size_t size_ = 0;
};

// The latest published version of the scene, and what each version before it changed. Copies are cheap: they share
// everything.
class PublishedScene {
  public:
    // How much is remembered for readers of earlier versions: about a minute at 60 versions per second.
    static constexpr std::size_t MaxVersions = 4096;
    static constexpr std::size_t MaxTouched = std::size_t{1} << 18;

    explicit PublishedScene(scene::Scene scene) : scene_(std::move(scene)) {}

    Version version() const { return scene_.version(); }
    Hash128 state_hash() const { return scene_.state_hash(); }
    const scene::Scene& scene() const { return scene_; }

    // The next version, and what it touched.
    void publish(scene::Scene scene, std::vector<TouchedObject> touched);

    scene::ChangeList snapshot() const { return scene::snapshot(scene_); }
    // None if `known` was never published, or is too old: use the snapshot.
    std::optional<MissedChanges> since(Version known) const;

  private:
    scene::Scene scene_;
    std::deque<TouchedObjects> log_;  // the last is of version()
    std::size_t log_size_ = 0;
};

}  // namespace tessera::master
