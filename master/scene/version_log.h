#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "mediator/scene/inverse.h"

namespace tessera::master {

// What of the head was published, and which objects each of the latest versions touched. The published scene
// is never copied: it is the head with the objects that changed since as they were. Pure.
class VersionLog {
  public:
    // So much is remembered for those who ask what happened since a version: at 60 versions a second a
    // minute.
    static constexpr std::size_t MaxVersions = 4096;
    static constexpr std::size_t MaxTouched = std::size_t{1} << 18;

    // `version` is that of `scene`.
    explicit VersionLog(const scene::Scene& scene);

    void changed(const std::vector<scene::ObjectChange>& changes);  // in the head, not published yet
    bool has_unpublished() const { return unpublished_; }

    Version version() const { return version_; }
    Version pending() const { return {version_.epoch, version_.number + (unpublished_ ? 1 : 0)}; }
    Hash128 state_hash() const { return state_hash_; }  // of the published scene

    // Everything since the last one, an object each; may be empty where edits took each other back. Needs
    // something unpublished.
    scene::ChangeList publish(const scene::Scene& head);

    // Of the published scene, however far the head is.
    scene::ChangeList snapshot(const scene::Scene& head) const;
    // Leads from `known` to the published scene; none when `known` is unknown or too old.
    std::optional<scene::ChangeList> since(Version known, const scene::Scene& head) const;

  private:
    const scene::Object* published(ObjectId id, const scene::Scene& head) const;

    struct Touched {
        ObjectId id;
        scene::FieldMask mask = 0;
        std::optional<scene::ObjectKind> was;  // before the version; none: was not there
    };
    Version version_;
    Hash128 state_hash_;
    bool unpublished_ = false;
    std::map<ObjectId, std::shared_ptr<const scene::Object>> before_;  // of the unpublished changes
    std::deque<std::vector<Touched>> log_;                             // the last is of version_
    std::size_t log_size_ = 0;
};

}  // namespace tessera::master
