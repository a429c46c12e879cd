#include "master/live/picture_effect.h"

#include <algorithm>
#include <variant>

#include "mediator/scene/fields.h"

namespace tessera::master {

namespace {

using namespace scene;

// Something that light meets or comes from, at or below `id`. Ends at the first one, so a part of the picture
// costs little; validated scenes have no cycles.
bool holds_content(const Scene& scene, ObjectId id) {
    const Object* object = scene.find(id);
    if (object == nullptr) return true;  // gone: not known, so it counts
    if (const auto* transform = std::get_if<Transform>(object)) {
        return std::any_of(transform->children.begin(), transform->children.end(),
                           [&](ObjectId child) { return holds_content(scene, child); });
    }
    return std::holds_alternative<Geometry>(*object) || std::holds_alternative<Light>(*object);
}

// Whether an update of these fields matters, one answer a kind.
struct Matters {
    const Update& update;
    const Scene& after;

    template <class T>
    bool any(Fields<T> fields) const {
        return Fields<T>::from_bits(update.mask).intersects(fields);
    }
    template <class T>
    bool any_but(Fields<T> fields) const {
        return any(Fields<T>::from_bits(~fields.bits()));
    }
    bool operator()(const Root&) const {
        return any<Root>({Root::Field::Children, Root::Field::Background, Root::Field::RenderOrigin});
    }
    bool operator()(const Transform&) const {
        if (any<Transform>(Transform::Field::Children)) return true;
        return any<Transform>({Transform::Field::Matrix, Transform::Field::Layers}) &&
               holds_content(after, update.id);
    }
    bool operator()(const Geometry&) const {
        return any_but<Geometry>({Geometry::Field::Name, Geometry::Field::Hint});
    }
    bool operator()(const Camera&) const { return false; }
    bool operator()(const Attachment&) const { return false; }
    template <class Other>
    bool operator()(const Other&) const {
        return any_but<Other>(Other::Field::Name);
    }
};

}  // namespace

bool changes_pictures(const ChangeList& changes, const Scene& after) {
    if (changes.is_snapshot()) return true;
    return std::any_of(changes.entries.begin(), changes.entries.end(), [&](const Entry& entry) {
        const auto* update = std::get_if<Update>(&entry);
        return update != nullptr && std::visit(Matters{*update, after}, update->fields);
    });
}

}  // namespace tessera::master
