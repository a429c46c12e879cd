#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/base/hash.h"
#include "mediator/scene/change_list.h"
#include "mediator/scene/object_map.h"

namespace tessera::scene {

// The state of a scene at one version: objects by id, in id order. Copies are cheap (copy on write), so that an editor
// can write v+1 while readers hold v, each with its own copy. One thread at a time per copy.
class Scene {
  public:
    Version version() const { return version_; }
    Hash128 state_hash() const { return state_hash_; }
    const Object* find(ObjectId id) const;  // null when absent
    template <class T>
    const T* find_as(ObjectId id) const {
        const Object* object = find(id);
        return object ? std::get_if<T>(object) : nullptr;
    }
    const ObjectMap& objects() const { return objects_; }

    // Applies all entries or none. InvalidInput: `from` is not this version (a snapshot replaces everything), an id
    // does not exist or already exists, a kind differs, or the resulting state hash is not that of the list.
    Expected<void> apply(const ChangeList& changes);

    // The same without checks of version and hash, for the scene authority and editors.
    Expected<void> apply_entries(const std::vector<Entry>& entries);
    void set_version(Version version) { version_ = version; }

  private:
    // The previous state of the objects, to undo a rejected list without a copy of the scene.
    using Journal = std::vector<std::pair<ObjectId, std::shared_ptr<const Object>>>;
    Expected<void> apply_entries(const std::vector<Entry>& entries, Journal& journal);
    Expected<void> apply_entry(const Entry& entry);
    void undo(const Journal& journal, Hash128 state_hash);

    Version version_;
    Hash128 state_hash_;
    ObjectMap objects_;
};

// The scene after a change list; fails like Scene::apply.
Expected<Scene> after(const Scene& before, const ChangeList& changes);

// The hash of one object at its id; the state hash is their sum.
Hash128 object_hash(ObjectId id, const Object& object);

// A change list from nothing to `scene`, for nodes and clients that join late.
ChangeList snapshot(const Scene& scene);

// The change list from a to b, field by field, with their versions.
ChangeList difference(const Scene& a, const Scene& b);

// Blobs that the objects refer to, each once.
std::vector<BlobRef> referenced_blobs(const Scene& scene);
std::vector<BlobRef> referenced_blobs(const Object& object);
std::vector<BlobRef> referenced_blobs(const Entry& entry);

}  // namespace tessera::scene
