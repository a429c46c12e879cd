#include "mediator/view/camera_scene.h"

#include <algorithm>
#include <unordered_map>

namespace tessera::view {

namespace {

using namespace scene;

const std::vector<ObjectId>* children_of(const Object& object) {
    if (const auto* root = std::get_if<Root>(&object)) return &root->children;
    if (const auto* transform = std::get_if<Transform>(&object)) return &transform->children;
    return nullptr;
}

// Which objects are cameras or have one below. Without recursion, and each object once: graphs may be deep and shared.
class CameraSearch {
  public:
    explicit CameraSearch(const Scene& scene) : scene_(scene) {
        enter(RootId);
        while (!open_.empty()) {
            Step& step = open_.back();
            if (step.next < step.children->size()) {
                enter((*step.children)[step.next++]);
                continue;
            }
            const bool leads =
                std::ranges::any_of(*step.children, [&](ObjectId child) { return keeps(child); });
            leads_[step.id] = leads;
            open_.pop_back();
        }
    }

    bool keeps(ObjectId id) const {
        const auto found = leads_.find(id);
        return found != leads_.end() && found->second;
    }
    const std::unordered_map<ObjectId, bool>& all() const { return leads_; }

  private:
    struct Step {
        ObjectId id;
        const std::vector<ObjectId>* children;
        std::size_t next = 0;
    };
    void enter(ObjectId id) {
        if (leads_.contains(id)) return;
        const Object* object = scene_.find(id);
        if (object == nullptr) return;
        const auto* children = children_of(*object);
        if (children == nullptr) {
            if (std::holds_alternative<Camera>(*object)) leads_[id] = true;
            return;
        }
        leads_[id] = false;
        open_.push_back({id, children});
    }

    const Scene& scene_;
    std::unordered_map<ObjectId, bool> leads_;
    std::vector<Step> open_;
};

}  // namespace

Scene camera_scene(const Scene& scene) {
    const CameraSearch search(scene);
    std::vector<Entry> entries;
    for (const auto& [id, keeps] : search.all()) {
        if (!keeps && id != RootId) continue;
        Object object = *scene.find(id);
        const auto is_left_out = [&](ObjectId child) { return !search.keeps(child); };
        if (auto* root = std::get_if<Root>(&object)) {
            std::erase_if(root->children, is_left_out);
            root->background = {};
        } else if (auto* transform = std::get_if<Transform>(&object)) {
            std::erase_if(transform->children, is_left_out);
        }
        entries.emplace_back(Create{id, std::move(object)});
    }
    Scene cameras;
    // Objects of a valid scene, each once: this cannot fail.
    if (auto applied = cameras.apply_entries(entries); !applied) throw applied.error();
    cameras.set_version(scene.version());
    return cameras;
}

}  // namespace tessera::view
