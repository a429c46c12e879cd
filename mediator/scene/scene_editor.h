#pragma once

#include <map>

#include "mediator/scene/fields.h"
#include "mediator/scene/scene.h"

namespace tessera::scene {

// Records what is written, where it is written, and coalesces at once: k writes of one field are one entry,
// create + update is a create, create + remove is nothing, remove + create of the same kind is an update of
// what differs. `base` must outlive the editor and not change meanwhile.
class SceneEditor {
  public:
    explicit SceneEditor(const Scene& base) : base_(base) {}

    void create(ObjectId id, Object object);  // throws Error when the id is taken
    void remove(ObjectId id);                 // throws Error when absent

    template <class T>
    void update(ObjectId id, Fields<T> mask, const T& fields) {
        write(id, mask.bits(), Object(fields));
    }
    void write(ObjectId id, FieldMask mask,
               const Object& fields);  // throws Error when absent or another kind
    void apply(const Entry& entry);

    const Object* find(ObjectId id) const;  // as the edit would leave it
    bool empty() const { return pending_.empty(); }

    // Entries in id order, without writes that changed nothing; leaves the editor empty.
    std::vector<Entry> take();

  private:
    // The state an object has after the edit; none: it goes. What changed is found by comparing with the
    // base.
    struct Pending {
        bool has_object = false;
        Object object;
    };
    const Scene& base_;
    std::map<ObjectId, Pending> pending_;
};

}  // namespace tessera::scene
