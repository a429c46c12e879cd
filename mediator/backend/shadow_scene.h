#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "mediator/backend/lowering.h"
#include "mediator/scene/fields.h"

namespace tessera::backend {

// What an edit means for a back-end: touched things only, each once, ascending. Everything else is as before.
struct SceneDelta {
    bool everything = false;         // a snapshot: nothing of before counts
    bool instances_changed = false;  // the flat list has other members; compare by value, not by index
    bool lights_changed = false;     // placed lights: members, places or values
    // Indices into lowered().instances, when not instances_changed: at another place or in other layers.
    std::vector<std::uint32_t> moved_instances;
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

// The back-end's mirror: dictionary and dispatch, shared by all back-ends (Schwenk 5.3.2.3). Deltas of
// consecutive lists add up until accept(), and until then rollback() undoes them. The result never
// depends on how the scene came about: it equals one that was made from a snapshot. Moving a transform costs
// the instances below it.
class ShadowScene {
  public:
    // All of a list or nothing. `after`: the scene that the list makes, of which it keeps a copy and so shares the
    // objects. InvalidInput: the list does not follow on what is here, or lower() refuses the scene.
    Expected<void> apply(const scene::ChangeList& changes, const scene::Scene& after);
    // For owners that keep no scene. InvalidInput: what Scene::apply refuses, too.
    Expected<void> apply(const scene::ChangeList& changes);
    // What changed since the last accept(), which makes it final: for a back-end whose device may refuse.
    SceneDelta pending() const;
    void accept();
    SceneDelta take_delta();  // both
    void rollback();          // to the state at the last accept(); nothing is pending then

    const scene::Scene& scene() const { return scene_; }
    const Lowered& lowered() const { return lowered_; }

  private:
    // What one list touches, read off its entries and the scene before it.
    struct Touched {
        bool structure = false;  // the flat lists may have other members
        std::vector<ObjectId> moved_transforms;
        std::vector<ObjectId> light_values;
        std::vector<SceneDelta::GeometryChange> changed_geometries;
        std::vector<ObjectId> created_geometries, removed_geometries, materials, textures;
        bool background = false, render_origin = false;
        std::uint32_t entries = 0, relevant = 0;
        std::set<std::string> ignored_kinds;
    };
    // The way back of one list.
    struct Undo {
        scene::Scene scene;
        std::vector<ObjectId> moved_transforms;
        std::optional<Lowered> lowered;  // instead of the moves, where the structure changed
    };

    Touched touch(const scene::ChangeList& changes) const;
    static void touch_created(Touched& touched, ObjectId id, const scene::Object& object);
    void touch_updated(Touched& touched, const scene::Update& update) const;
    static void touch_removed(Touched& touched, ObjectId id, const scene::Object& object);
    void replace_everything();
    void record(const Touched& touched);
    void record_relowering(const Lowered& before);
    // Places what hangs below the transforms anew; true when lights are among it.
    bool move_below(const std::vector<ObjectId>& transforms, std::set<std::uint32_t>& moved);
    void index_paths();
    void forget_index();

    scene::Scene scene_;
    Lowered lowered_;
    SceneDelta delta_;
    std::vector<Undo> undo_;
    std::set<std::uint32_t> moved_;                                   // becomes delta_.moved_instances
    std::unordered_map<ObjectId, std::uint32_t> changed_geometries_;  // field bits, since the last accept()
    std::set<ObjectId> created_geometries_, removed_geometries_, materials_, textures_;
    std::set<std::string> ignored_kinds_;

    bool indexed_ = false;  // the two maps hold, for every transform, what hangs below it
    std::unordered_map<ObjectId, std::vector<std::uint32_t>> instances_below_, lights_below_;
};

}  // namespace tessera::backend
