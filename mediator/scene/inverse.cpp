#include "mediator/scene/inverse.h"

#include <map>

#include "mediator/scene/fields.h"

namespace tessera::scene {

namespace {

std::shared_ptr<const Object> shared_object(const Scene& scene, ObjectId id) {
    const auto it = scene.objects().find(id);
    return it == scene.objects().end() ? nullptr : it->second;
}

}  // namespace

Expected<std::vector<ObjectChange>> apply_and_observe(Scene& scene, const std::vector<Entry>& entries) {
    std::map<ObjectId, std::shared_ptr<const Object>> before;
    for (const Entry& entry : entries) before.try_emplace(id(entry), shared_object(scene, id(entry)));
    if (auto applied = scene.apply_entries(entries); !applied) return tl::unexpected(applied.error());
    std::vector<ObjectChange> changes;
    for (auto& [id, old] : before) {
        ObjectChange change{.id = id, .before = std::move(old), .after = shared_object(scene, id)};
        if (!change.before && !change.after) continue;
        if (change.is_update()) {
            change.mask = differing_fields(*change.before, *change.after);
            if (change.mask == 0) continue;
        } else {
            change.mask = all_fields(change.after ? *change.after : *change.before);
        }
        changes.push_back(std::move(change));
    }
    return changes;
}

std::vector<Entry> inverse(std::span<const ObjectChange> changes) {
    std::vector<Entry> entries;
    for (const ObjectChange& change : changes) {
        if (change.is_update()) {
            entries.emplace_back(Update{change.id, change.mask, copy_of_fields(*change.before, change.mask)});
            continue;
        }
        if (change.after) entries.emplace_back(Remove{change.id});
        if (change.before) entries.emplace_back(Create{change.id, *change.before});
    }
    return entries;
}

Object copy_of_fields(const Object& object, FieldMask mask) {
    Object result = std::visit([]<class T>(const T&) { return Object(T{}); }, object);
    assign(result, object, mask);
    return result;
}

}  // namespace tessera::scene
