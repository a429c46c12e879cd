#pragma once

#include <memory>
#include <span>
#include <vector>

#include "mediator/scene/scene.h"

namespace tessera::scene {

// What entries did to one object. The states are those of the scenes, not copies. Null = not there.
struct ObjectChange {
    ObjectId id;
    FieldMask mask = 0;  // fields that changed; all, unless both states are there and of one kind
    std::shared_ptr<const Object> before, after;

    bool is_update() const { return before && after && before->index() == after->index(); }
};

// Applies in full or not at all, as Scene::apply_entries, and tells what it did, an object each in id order;
// objects that are bit for bit what they were are not told.
Expected<std::vector<ObjectChange>> apply_and_observe(Scene& scene, const std::vector<Entry>& entries);

// The entries that take the changes back: after them the scene is what it was, bit for bit. They hold only
// the fields they need. Cost is that of the objects.
std::vector<Entry> inverse(std::span<const ObjectChange> changes);

// An object of the same kind with these fields, the others as they are by default.
Object only(const Object& object, FieldMask mask);

}  // namespace tessera::scene
