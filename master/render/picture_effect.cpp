#include "master/render/picture_effect.h"

#include <algorithm>
#include <set>
#include <variant>
#include <vector>

#include "mediator/scene/fields.h"
#include "mediator/scene/referrers.h"

namespace tessera::master {

namespace {

using namespace scene;

// Searches for a geometry, light or background at or below an object. Stops at the first one, so visible subtrees cost
// little; subtrees without one are visited once, however deep and shared they are.
class ContentSearch {
  public:
    explicit ContentSearch(const Scene& scene) : scene_(scene) {}

    bool finds_any(ObjectId start) {
        struct Step {
            const std::vector<ObjectId>* below;
            std::size_t next = 0;
        };
        const std::vector<ObjectId> top{start};
        std::vector<Step> open{{&top}};
        while (!open.empty()) {
            Step& step = open.back();
            if (step.next == step.below->size()) {
                open.pop_back();
                continue;
            }
            const ObjectId id = (*step.below)[step.next++];
            const Object* object = scene_.find(id);
            if (object == nullptr) return true;  // removed: unknown, so it counts
            if (std::holds_alternative<Geometry>(*object) || std::holds_alternative<Light>(*object))
                return true;
            const std::vector<ObjectId>& below = children(*object);
            if (!below.empty() && walked_.insert(id).second) open.push_back({&below});
        }
        return false;
    }

  private:
    const Scene& scene_;
    std::set<ObjectId> walked_;  // without a match
};

// Whether an update of these fields matters, per kind.
struct Matters {
    const Update& update;
    ContentSearch& content;

    template <class T>
    bool any(Fields<T> fields) const {
        return Fields<T>::from_bits(update.mask).intersects(fields);
    }
    template <class T>
    bool any_but(Fields<T> fields) const {
        return any(Fields<T>::from_bits(~fields.bits()));
    }
    bool operator()(const Root&) const {
        return any<Root>({&Root::children, &Root::background, &Root::render_origin});
    }
    bool operator()(const Transform&) const {
        if (any<Transform>(&Transform::children)) return true;
        return any<Transform>({&Transform::matrix, &Transform::motion, &Transform::layers}) &&
               content.finds_any(update.id);
    }
    bool operator()(const Geometry&) const { return any_but<Geometry>({&Geometry::name, &Geometry::hint}); }
    bool operator()(const Camera&) const { return false; }
    bool operator()(const Attachment&) const { return false; }
    template <class Other>
    bool operator()(const Other&) const {
        return any_but<Other>(&Other::name);
    }
};

}  // namespace

bool changes_pictures(const ChangeList& changes, const Scene& after) {
    if (changes.is_snapshot()) return true;
    ContentSearch content(after);
    return std::any_of(changes.entries.begin(), changes.entries.end(), [&](const Entry& entry) {
        const auto* update = std::get_if<Update>(&entry);
        return update != nullptr && std::visit(Matters{*update, content}, update->fields);
    });
}

}  // namespace tessera::master
