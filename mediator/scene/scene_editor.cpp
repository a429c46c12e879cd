#include "mediator/scene/scene_editor.h"

#include <utility>

namespace tessera::scene {

namespace {

Error refused(ObjectId id, const std::string& cause) {
    return Error(ErrorCode::InvalidInput, "object " + std::to_string(id.value) + " " + cause);
}

}  // namespace

const Object* SceneEditor::find(ObjectId id) const {
    const auto place = pending_.find(id);
    if (place == pending_.end()) return base_.find(id);
    return place->second.has_object ? &place->second.object : nullptr;
}

void SceneEditor::create(ObjectId id, Object object) {
    if (find(id) != nullptr) throw refused(id, "is there already: choose another id");
    pending_[id] = {.has_object = true, .object = std::move(object)};
}

void SceneEditor::remove(ObjectId id) {
    if (find(id) == nullptr) throw refused(id, "is not there: it cannot be removed");
    if (base_.find(id) == nullptr) {
        pending_.erase(id);
        return;
    }
    pending_[id] = {};
}

void SceneEditor::write(ObjectId id, FieldMask mask, const Object& fields) {
    const Object* present = find(id);
    if (present == nullptr) throw refused(id, "is not there: create it first");
    if (present->index() != fields.index()) {
        throw refused(id, std::string("is a ") + name(kind(*present)) + ": it has no fields of a " +
                              name(kind(fields)));
    }
    const auto [place, fresh] = pending_.try_emplace(id);
    Pending& pending = place->second;
    if (fresh) {
        pending.object = *present;
        pending.has_object = true;
    }
    assign(pending.object, fields, mask);
}

void SceneEditor::apply(const Entry& entry) {
    if (const auto* created = std::get_if<Create>(&entry)) {
        create(created->id, created->object);
    } else if (const auto* updated = std::get_if<Update>(&entry)) {
        write(updated->id, updated->mask, updated->fields);
    } else {
        remove(std::get<Remove>(entry).id);
    }
}

std::vector<Entry> SceneEditor::take() {
    std::vector<Entry> entries;
    for (auto& [id, pending] : pending_) {
        const Object* base = base_.find(id);
        if (!pending.has_object) {
            entries.push_back(Remove{id});
        } else if (base == nullptr) {
            entries.push_back(Create{id, std::move(pending.object)});
        } else if (base->index() != pending.object.index()) {
            // Another kind under the same id: the only case with two entries.
            entries.push_back(Remove{id});
            entries.push_back(Create{id, std::move(pending.object)});
        } else if (const FieldMask mask = differing_fields(*base, pending.object); mask != 0) {
            entries.push_back(Update{id, mask, std::move(pending.object)});
        }
    }
    pending_.clear();
    return entries;
}

}  // namespace tessera::scene
