#pragma once

#include "mediator/base/random.h"
#include "mediator/scene/scene_editor.h"
#include "tests/contract/contract_scene.h"

namespace tessera::test {

// Starts from the contract scene and edits it at random, repeatably: transforms move, appear, are shared and
// removed from their parents; geometries are created, deformed, get other materials and are removed; lights, materials, hints, layers, sky and
// render origin change. Never a cycle (a child's id is above its parent's), never more than some hundred
// instances.
class RandomEdits {
  public:
    RandomEdits(std::uint64_t seed, scene::BlobStore& blobs) : random_(seed), blobs_(blobs) {}

    scene::ChangeList start() { return builder_.edit(contract_scene(blobs_)); }
    scene::ChangeList next();
    const scene::Scene& scene() const { return builder_.scene(); }

  private:
    void change(scene::SceneEditor& editor);
    void grow(scene::SceneEditor& editor);
    void remove_child(scene::SceneEditor& editor);
    void add_shared_child(scene::SceneEditor& editor);
    void deform(scene::SceneEditor& editor);
    void tint(scene::SceneEditor& editor);
    std::vector<ObjectId> ids(scene::ObjectKind kind) const;
    ObjectId any(scene::ObjectKind kind);
    glm::dmat4 placement();
    void hook(scene::SceneEditor& editor, ObjectId parent, ObjectId child);
    // None half of the time, else any of three.
    std::uint32_t layers() { return static_cast<std::uint32_t>(random_.below(2) * random_.below(8)); }
    float unit() { return static_cast<float>(random_.uniform()); }

    CounterRandom random_;
    scene::BlobStore& blobs_;
    SceneBuilder builder_;
    std::uint64_t next_id_ = 100;
};

}  // namespace tessera::test
