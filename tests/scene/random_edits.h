#pragma once

#include <vector>

#include "mediator/base/random.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/referrers.h"
#include "mediator/scene/scene_editor.h"

namespace tessera::scene {

// Random edits for any scene, repeatable by seed, and some invalid ones. New
// objects get ids from `first_id` on.
class RandomEdits {
  public:
    RandomEdits(std::uint64_t seed, std::uint64_t first_id) : random_(seed), next_id_(first_id) {}

    // One to three steps as one edit; coalesced, as a client would send it. May be empty.
    std::vector<Entry> next(const Scene& scene) {
        SceneEditor editor(scene);
        for (std::uint64_t steps = 1 + random_.below(3); steps > 0; --steps) step(scene, editor);
        return editor.take();
    }

    // Invalid edits: a reference to nothing, a cycle, a wrong kind, a number out of range.
    std::vector<Entry> impossible(const Scene& scene) {
        const ObjectId target = some(scene, ObjectKind::Transform);
        switch (random_.below(4)) {
            case 0: {
                Geometry geometry = mesh();
                geometry.material = ObjectId{4'000'000'000};
                return {Create{ObjectId{next_id_++}, geometry}};
            }
            case 1: {
                if (!target) return {Remove{ObjectId{4'000'000'000}}};
                Transform self;
                self.children = {target};
                return {Update{target, Fields<Transform>(&Transform::children).bits(), self}};
            }
            case 2:
                return {Create{ObjectId{next_id_++}, Material{.roughness = 7.0f}}};
            default: {
                Root root;
                root.background = RootId;
                return {Update{RootId, Fields<Root>(&Root::background).bits(), root}};
            }
        }
    }

    // What the blobs of all its meshes are.
    static const Blob& mesh_bytes() {
        static const Blob Bytes(std::vector<std::byte>(36));
        return Bytes;
    }

    std::uint64_t below(std::uint64_t n) { return random_.below(n); }

    ObjectId some(const Scene& scene, ObjectKind wanted) {
        std::vector<ObjectId> found;
        for (const auto& [id, object] : scene.objects()) {
            if (kind(*object) == wanted) found.push_back(id);
        }
        return found.empty() ? ObjectId{} : found[random_.below(found.size())];
    }

  private:
    float number() { return static_cast<float>(random_.below(1000)) / 1000.0f; }
    static Geometry mesh() {
        const BlobRef bytes = reference(mesh_bytes());
        return {.indices = bytes, .positions = bytes};
    }

    void step(const Scene& scene, SceneEditor& editor) {
        switch (random_.below(8)) {
            case 0:
            case 1:
                return create(scene, editor);
            case 2:
                return remove(scene, editor);
            case 3:
                return move_child(scene, editor);
            default:
                return set_fields(scene, editor);
        }
    }

    void create(const Scene& scene, SceneEditor& editor) {
        const ObjectId id{next_id_++};
        switch (random_.below(4)) {
            case 0:
                editor.create(id, Material{.name = "paint", .roughness = number()});
                return;
            case 1: {
                Geometry geometry = mesh();
                const ObjectId material = some(scene, ObjectKind::Material);
                if (material && editor.find(material)) geometry.material = material;
                editor.create(id, geometry);
                break;
            }
            case 2:
                editor.create(id, Transform{.name = "group"});
                break;
            default:
                editor.create(id, Light{.intensity = glm::vec3(number())});
        }
        const ObjectId parent = random_.below(2) ? some(scene, ObjectKind::Transform) : RootId;
        if (parent && editor.find(parent)) {
            std::vector<ObjectId> list = children(*editor.find(parent));
            list.insert(list.begin() + static_cast<std::ptrdiff_t>(random_.below(list.size() + 1)), id);
            set_children(editor, parent, list);
        }
    }

    // With every reference to it.
    void remove(const Scene& scene, SceneEditor& editor) {
        constexpr ObjectKind Kinds[]{ObjectKind::Light, ObjectKind::Geometry, ObjectKind::Material,
                                     ObjectKind::Transform};
        const ObjectId id = some(scene, Kinds[random_.below(4)]);
        if (!id || editor.find(id) == nullptr) return;
        for (const auto& [other, object] : scene.objects()) {
            const Object* now = editor.find(other);
            if (now == nullptr) continue;
            std::vector<ObjectId> list = children(*now);
            if (std::erase(list, id) != 0) set_children(editor, other, list);
            now = editor.find(other);
            if (const auto* geometry = std::get_if<Geometry>(now); geometry && geometry->material == id)
                editor.update(other, Fields<Geometry>(&Geometry::material), Geometry{});
        }
        editor.remove(id);
    }

    void move_child(const Scene& scene, SceneEditor& editor) {
        const ObjectId from = random_.below(2) ? some(scene, ObjectKind::Transform) : RootId;
        const ObjectId to = random_.below(2) ? some(scene, ObjectKind::Transform) : RootId;
        if (!from || !to || !editor.find(from) || !editor.find(to)) return;
        std::vector<ObjectId> list = children(*editor.find(from));
        if (list.empty()) return;
        const std::size_t place = random_.below(list.size());
        const ObjectId child = list[place];
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(place));
        set_children(editor, from, list);
        list = children(*editor.find(to));
        list.push_back(child);  // may close a cycle: then the edit is one that cannot be
        set_children(editor, to, list);
    }

    void set_fields(const Scene& scene, SceneEditor& editor) {
        constexpr ObjectKind Kinds[]{ObjectKind::Light, ObjectKind::Material, ObjectKind::Transform};
        const ObjectId id = some(scene, Kinds[random_.below(3)]);
        const Object* present = id ? editor.find(id) : nullptr;
        if (present == nullptr) return;
        Object changed = *present;
        if (auto* light = std::get_if<Light>(&changed)) {
            light->intensity = glm::vec3(number());
            if (random_.below(3) == 0) light->name = "lamp " + std::to_string(random_.below(9));
        } else if (auto* material = std::get_if<Material>(&changed)) {
            (random_.below(2) ? material->roughness : material->metallic) = number();
        } else if (auto* transform = std::get_if<Transform>(&changed)) {
            transform->matrix[3][0] = number();
        }
        editor.write(id, differing_fields(*present, changed), changed);
    }

    void set_children(SceneEditor& editor, ObjectId parent, const std::vector<ObjectId>& list) {
        Object changed = *editor.find(parent);
        if (auto* root = std::get_if<Root>(&changed)) root->children = list;
        if (auto* transform = std::get_if<Transform>(&changed)) transform->children = list;
        editor.write(parent, children_field(kind(changed)), changed);
    }

    CounterRandom random_;
    std::uint64_t next_id_;
};

}  // namespace tessera::scene
