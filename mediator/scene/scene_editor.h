#pragma once

#include <map>

#include "mediator/scene/fields.h"
#include "mediator/scene/scene.h"

namespace tessera::scene {

// Collects writes and coalesces them: k writes of one field are one entry, create + update is a create, create +
// remove is nothing, remove + create of the same kind is an update of the fields that differ. `base` must outlive the
// editor and not change meanwhile.
class SceneEditor {
  public:
    explicit SceneEditor(const Scene& base) : base_(base) {}

    void create(ObjectId id, Object object);  // throws Error if the id exists
    void remove(ObjectId id);                 // throws Error if absent

    template <class T>
    void update(ObjectId id, Fields<T> mask, const T& fields) {
        write(id, mask.bits(), Object(fields));
    }
    void write(ObjectId id, FieldMask mask,
               const Object& fields);  // throws Error if absent or of another kind
    void apply(const Entry& entry);

    const Object* find(ObjectId id) const;  // as after the edit
    bool empty() const { return pending_.empty(); }

    // The entries in id order, without writes that change nothing; the editor is empty afterwards.
    std::vector<Entry> take();

  private:
    // The state of an object after the edit; none = removed. The changed fields follow by comparison with the base.
    struct Pending {
        bool has_object = false;
        Object object;
    };
    const Scene& base_;
    std::map<ObjectId, Pending> pending_;
};

}  // namespace tessera::scene
