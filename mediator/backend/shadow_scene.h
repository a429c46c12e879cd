#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mediator/backend/lowering.h"
#include "mediator/scene/fields.h"

namespace tessera::backend {

// What an edit means for a back-end: touched things only, each once, ascending. Everything else is as before.
struct SceneDelta {
    bool everything = false;         // a snapshot: nothing of before counts
    bool instances_changed = false;  // the flat list has other members; compare by value, not by index
    bool lights_changed = false;     // placed lights: members, places or values
    std::vector<std::uint32_t> moved_instances;  // indices into lowered().instances, when not instances_changed
    struct GeometryChange {
        ObjectId id;
        scene::Fields<scene::Geometry> fields;
    };
    std::vector<GeometryChange> geometries;  // created (all fields) or changed
    std::vector<ObjectId> removed_geometries;
    std::vector<ObjectId> materials, textures;  // created, changed or removed
    bool background_changed = false;
    bool render_origin_changed = false;
    std::uint32_t entries = 0, relevant = 0;
    std::vector<std::string> ignored_kinds;  // kinds among the entries that no back-end draws (attachments)
};

// The back-end's mirror: dictionary and dispatch, shared by all back-ends (Schwenk 5.3.2.3). Deltas of consecutive
// lists add up until take_delta(). The result never depends on how the scene came about.
class ShadowScene {
  public:
    Expected<void> apply(const scene::ChangeList& changes);
    SceneDelta take_delta();

    const scene::Scene& scene() const { return scene_; }
    const Lowered& lowered() const { return lowered_; }

  private:
    void note(const scene::Entry& entry, const scene::Scene& before);

    scene::Scene scene_;
    Lowered lowered_;
    SceneDelta delta_;
};

}  // namespace tessera::backend
