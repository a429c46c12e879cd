#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "master/scene/published_scene.h"
#include "mediator/scene/inverse.h"

namespace tessera::master {

// The published version of the scene, and the changes of the head since then. Pure.
class VersionLog {
  public:
    explicit VersionLog(const scene::Scene& scene) : published_(scene) {}  // published at its version

    void changed(const std::vector<scene::ObjectChange>& changes);  // in the head, not published yet
    bool has_unpublished() const { return unpublished_; }
    std::size_t unpublished_objects() const { return before_.size(); }

    const PublishedScene& published() const { return published_; }
    Version pending() const;  // the version of the head once it is published

    // Publishes the head at pending(), and sets its version. The list has all changes since the last version, one entry
    // per object; it is empty if the edits cancel each other. Requires unpublished changes.
    scene::ChangeList publish(scene::Scene& head);

  private:
    PublishedScene published_;
    bool unpublished_ = false;
    std::map<ObjectId, std::shared_ptr<const scene::Object>> before_;  // of the unpublished changes
};

// Appends what leads from an object of kind `was` (none: there is no object) to `now`, whose fields of the mask differ.
void add_entries(ObjectId id, std::optional<scene::ObjectKind> was, scene::FieldMask mask,
                 const scene::Object* now, std::vector<scene::Entry>& entries);

}  // namespace tessera::master
