#include "mediator/scene/scene.h"

#include <algorithm>

#include "mediator/scene/field_values.h"
#include "mediator/scene/fields.h"

namespace tessera::scene {

namespace {

std::string text(Version version) {
    return std::to_string(version.epoch) + ":" + std::to_string(version.number);
}

Error entry_error(ObjectId id, const std::string& cause) {
    return Error(ErrorCode::InvalidInput, "object " + std::to_string(id.value) + " " + cause);
}

}  // namespace

ObjectId id(const Entry& entry) {
    return std::visit([](const auto& value) { return value.id; }, entry);
}

Hash128 object_hash(ObjectId id, const Object& object) {
    Blake2b hash;
    feed(hash, id);
    feed(hash, kind(object));
    std::visit([&](const auto& value) { feed(hash, value); }, object);
    return truncated(hash.finish());
}

const Object* Scene::find(ObjectId id) const {
    const auto place = objects_.find(id);
    return place == objects_.end() ? nullptr : place->second.get();
}

Expected<void> Scene::apply(const ChangeList& changes) {
    const auto wrong_hash = [&] {
        return failure(ErrorCode::InvalidInput,
                       "the scene after version " + text(changes.to) +
                           " has another state hash than promised: ask for a snapshot");
    };
    if (changes.is_snapshot()) {
        Scene next;
        if (auto applied = next.apply_entries(changes.entries); !applied) return applied;
        if (next.state_hash_ != changes.state_hash) return wrong_hash();
        next.version_ = changes.to;
        *this = std::move(next);
        return {};
    }
    if (changes.from != version_) {
        return failure(ErrorCode::InvalidInput, "a change list from version " + text(changes.from) +
                                                    " does not follow version " + text(version_) +
                                                    ": ask for a snapshot");
    }
    const Hash128 before = state_hash_;
    Journal journal;
    if (auto applied = apply_entries(changes.entries, journal); !applied) return applied;
    if (state_hash_ != changes.state_hash) {
        undo(journal, before);
        return wrong_hash();
    }
    version_ = changes.to;
    return {};
}

Expected<void> Scene::apply_entries(const std::vector<Entry>& entries) {
    Journal journal;
    return apply_entries(entries, journal);
}

Expected<void> Scene::apply_entries(const std::vector<Entry>& entries, Journal& journal) {
    const Hash128 before = state_hash_;
    for (const Entry& entry : entries) {
        const auto place = objects_.find(id(entry));
        journal.emplace_back(id(entry), place == objects_.end() ? nullptr : place->second);
        if (auto applied = apply_entry(entry); !applied) {
            undo(journal, before);
            return applied;
        }
    }
    return {};
}

void Scene::undo(const Journal& journal, Hash128 state_hash) {
    for (auto entry = journal.rbegin(); entry != journal.rend(); ++entry) {
        if (entry->second) {
            objects_.set(entry->first, entry->second);
        } else {
            objects_.erase(entry->first);
        }
    }
    state_hash_ = state_hash;
}

Expected<void> Scene::apply_entry(const Entry& entry) {
    const ObjectId target = id(entry);
    const auto place = objects_.find(target);
    if (const auto* create = std::get_if<Create>(&entry)) {
        if (place != objects_.end())
            return tl::unexpected(entry_error(target, "is there already: it cannot be created"));
        state_hash_ += object_hash(target, create->object);
        objects_.set(target, std::make_shared<const Object>(create->object));
        return {};
    }
    if (place == objects_.end())
        return tl::unexpected(entry_error(target, "is not there: it cannot be changed or removed"));
    state_hash_ -= object_hash(target, *place->second);
    const auto* update = std::get_if<Update>(&entry);
    if (update == nullptr) {
        objects_.erase(target);
        return {};
    }
    if (update->fields.index() != place->second->index()) {
        return tl::unexpected(entry_error(target, std::string("is a ") + name(kind(*place->second)) +
                                                      ": it cannot be changed like a " +
                                                      name(kind(update->fields))));
    }
    Object changed = *place->second;
    assign(changed, update->fields, update->mask);
    state_hash_ += object_hash(target, changed);
    objects_.set(target, std::make_shared<const Object>(std::move(changed)));
    return {};
}

Expected<Scene> after(const Scene& before, const ChangeList& changes) {
    Scene scene = before;
    if (Expected<void> applied = scene.apply(changes); !applied) return tl::unexpected(applied.error());
    return scene;
}

ChangeList snapshot(const Scene& scene) {
    ChangeList changes{
        .from = {scene.version().epoch, 0}, .to = scene.version(), .state_hash = scene.state_hash()};
    for (const auto& [id, object] : scene.objects()) changes.entries.push_back(Create{id, *object});
    return changes;
}

ChangeList difference(const Scene& a, const Scene& b) {
    ChangeList changes{.from = a.version(), .to = b.version(), .state_hash = b.state_hash()};
    for (const auto& [id, object] : a.objects()) {
        const Object* now = b.find(id);
        if (now == nullptr || now->index() != object->index()) changes.entries.push_back(Remove{id});
    }
    for (const auto& [id, object] : b.objects()) {
        const Object* before = a.find(id);
        if (before == nullptr || before->index() != object->index()) {
            changes.entries.push_back(Create{id, *object});
        } else if (const FieldMask mask = differing_fields(*before, *object); mask != 0) {
            changes.entries.push_back(Update{id, mask, *object});
        }
    }
    return changes;
}

std::vector<BlobRef> referenced_blobs(const Object& object) {
    std::vector<BlobRef> blobs;
    const auto add = [&](const BlobRef& blob) {
        if (!blob.empty()) blobs.push_back(blob);
    };
    std::visit(
        [&]<class T>(const T& value) {
            for_each_field<T>([&](unsigned, auto member) {
                using V = std::decay_t<decltype(value.*member)>;
                if constexpr (std::is_same_v<V, BlobRef>) {
                    add(value.*member);
                } else if constexpr (std::is_same_v<V, std::vector<BlobRef>>) {
                    for (const BlobRef& blob : value.*member) add(blob);
                }
            });
        },
        object);
    return blobs;
}

std::vector<BlobRef> referenced_blobs(const Entry& entry) {
    if (const auto* create = std::get_if<Create>(&entry)) return referenced_blobs(create->object);
    if (const auto* update = std::get_if<Update>(&entry)) return referenced_blobs(update->fields);
    return {};
}

std::vector<BlobRef> referenced_blobs(const Scene& scene) {
    std::vector<BlobRef> blobs;
    for (const auto& [id, object] : scene.objects()) {
        for (const BlobRef& blob : referenced_blobs(*object)) blobs.push_back(blob);
    }
    std::sort(blobs.begin(), blobs.end());
    blobs.erase(std::unique(blobs.begin(), blobs.end()), blobs.end());
    return blobs;
}

}  // namespace tessera::scene
