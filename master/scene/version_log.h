#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "mediator/scene/inverse.h"

namespace tessera::master {

// The published state of the scene, and the objects that each of the latest versions touched. The published scene is
// never copied: it is the head with the unpublished objects' previous values. Pure.
class VersionLog {
  public:
    // How much is remembered for queries of changes since a version: about a minute at 60 versions per second.
    static constexpr std::size_t MaxVersions = 4096;
    static constexpr std::size_t MaxTouched = std::size_t{1} << 18;

    // `version` is that of `scene`.
    explicit VersionLog(const scene::Scene& scene);

    void changed(const std::vector<scene::ObjectChange>& changes);  // in the head, not published yet
    bool has_unpublished() const { return unpublished_; }

    Version version() const { return version_; }
    Version pending() const { return {version_.epoch, version_.number + (unpublished_ ? 1 : 0)}; }
    Hash128 state_hash() const { return state_hash_; }  // of the published scene

    // All changes since the last version, one entry per object; empty if the edits cancel each other. Requires
    // unpublished changes.
    scene::ChangeList publish(const scene::Scene& head);

    // Of the published scene, without unpublished edits.
    scene::ChangeList snapshot(const scene::Scene& head) const;
    scene::Scene published(const scene::Scene& head) const;  // the published scene itself
    // Changes from `known` to the published scene; none if `known` is unknown or too old.
    std::optional<scene::ChangeList> since(Version known, const scene::Scene& head) const;

  private:
    const scene::Object* published(ObjectId id, const scene::Scene& head) const;

    struct Touched {
        ObjectId id;
        scene::FieldMask mask = 0;
        std::optional<scene::ObjectKind> was;  // its kind before the version; none: it did not exist
    };
    Version version_;
    Hash128 state_hash_;
    bool unpublished_ = false;
    std::map<ObjectId, std::shared_ptr<const scene::Object>> before_;  // of the unpublished changes
    std::deque<std::vector<Touched>> log_;                             // the last is of version_
    std::size_t log_size_ = 0;
};

}  // namespace tessera::master
