#pragma once

#include <memory>
#include <span>
#include <vector>

#include "mediator/scene/scene.h"

namespace tessera::scene {

// The effect of entries on one object. The states are shared with the scenes, not copied. Null = absent.
struct ObjectChange {
    ObjectId id;
    FieldMask mask = 0;  // changed fields; all, unless both states exist and have the same kind
    std::shared_ptr<const Object> before, after;

    bool is_update() const { return before && after && before->index() == after->index(); }
};

// Applies all entries or none, as Scene::apply_entries, and returns the changes by object, in id order; without
// objects whose bits are unchanged.
Expected<std::vector<ObjectChange>> apply_and_observe(Scene& scene, const std::vector<Entry>& entries);

// The entries that undo the changes and restore the scene bit for bit. They hold only the necessary fields. The cost
// is proportional to these objects.
std::vector<Entry> inverse(std::span<const ObjectChange> changes);

// An object of the same kind with a copy of these fields; the others have their defaults.
Object copy_of_fields(const Object& object, FieldMask mask);

}  // namespace tessera::scene
