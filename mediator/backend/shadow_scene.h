#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "mediator/backend/flattening.h"
#include "mediator/scene/fields.h"

namespace tessera::backend {

// The effect of an edit on a back-end: the ids that changed, each once, ascending.
struct SceneDelta {
    bool everything = false;         // a snapshot replaced the whole scene
    bool instances_changed = false;  // instances were added or removed: indices are not comparable
    bool lights_changed = false;     // placed lights: added, removed, moved or with other values
    // Indices into flat_scene().instances with another transform or other layers; only if not instances_changed.
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
    std::vector<std::string> ignored_kinds;  // object kinds of the edit that back-ends ignore (attachments)
};

// As if the scene had arrived as a snapshot.
SceneDelta everything_in(const scene::Scene& scene);

// A back-end's copy of the scene and its flattened form, shared by all back-ends (Schwenk 5.3.2.3). Deltas of
// consecutive lists accumulate until accept(); until then rollback() undoes them. The result does not depend on the
// edit history: it equals that of a snapshot. The cost of moving a transform is proportional to the instances below it.
class ShadowScene {
  public:
    // All of a list or nothing. `after` is the scene that results from it; a copy is kept, which shares the objects.
    // InvalidInput: the list starts at another version, or flatten() rejects the scene.
    Expected<void> apply(const scene::ChangeList& changes, const scene::Scene& after);
    // For callers without a scene. InvalidInput also for whatever Scene::apply rejects.
    Expected<void> apply(const scene::ChangeList& changes);
    // The changes since the last accept(). accept() makes them final, after the device has taken them.
    SceneDelta pending() const;
    void accept();
    SceneDelta take_delta();  // both
    void rollback();          // to the state at the last accept(); nothing is pending then

    const scene::Scene& scene() const { return scene_; }
    const FlatScene& flat_scene() const { return flat_scene_; }

  private:
    // The objects that a list touches, from its entries and the scene before it.
    struct Touched {
        bool structure = false;  // instances or lights may be added or removed
        std::vector<ObjectId> moved_transforms;
        std::vector<ObjectId> light_values;
        std::vector<SceneDelta::GeometryChange> changed_geometries;
        std::vector<ObjectId> created_geometries, removed_geometries, materials, textures;
        bool background = false, render_origin = false;
        std::uint32_t entries = 0, relevant = 0;
        std::set<std::string> ignored_kinds;
    };
    // Undoes one list.
    struct Undo {
        scene::Scene scene;
        std::vector<ObjectId> moved_transforms;
        std::optional<FlatScene> flat_scene;  // set if the structure changed; else moved_transforms suffices
    };

    Touched touch(const scene::ChangeList& changes) const;
    static void touch_created(Touched& touched, ObjectId id, const scene::Object& object);
    void touch_updated(Touched& touched, const scene::Update& update) const;
    static void touch_removed(Touched& touched, ObjectId id, const scene::Object& object);
    void replace_everything();
    void record(const Touched& touched);
    void record_reflattening(const FlatScene& before);
    // Updates the transforms of the instances and lights below; returns whether there were lights.
    bool move_below(const std::vector<ObjectId>& transforms, std::set<std::uint32_t>& moved);
    void index_paths();
    void forget_index();

    scene::Scene scene_;
    FlatScene flat_scene_;
    SceneDelta delta_;
    std::vector<Undo> undo_;
    std::set<std::uint32_t> moved_;                                   // becomes delta_.moved_instances
    std::unordered_map<ObjectId, std::uint32_t> changed_geometries_;  // field bits, since the last accept()
    std::set<ObjectId> created_geometries_, removed_geometries_, materials_, textures_;
    std::set<std::string> ignored_kinds_;

    bool indexed_ =
        false;  // whether the two maps are filled: of every transform the instances and lights below it
    std::unordered_map<ObjectId, std::vector<std::uint32_t>> instances_below_, lights_below_;
};

}  // namespace tessera::backend
