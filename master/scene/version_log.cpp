#include "master/scene/version_log.h"

#include "mediator/scene/fields.h"

namespace tessera::master {

namespace {

std::optional<scene::ObjectKind> kind_of(const scene::Object* object) {
    return object ? std::optional(kind(*object)) : std::nullopt;
}

}  // namespace

void add_entries(ObjectId id, std::optional<scene::ObjectKind> was, scene::FieldMask mask,
                 const scene::Object* now, std::vector<scene::Entry>& entries) {
    if (was && now && *was == kind(*now)) {
        if (mask != 0) entries.push_back(scene::Update{id, mask, scene::copy_of_fields(*now, mask)});
        return;
    }
    if (was) entries.emplace_back(scene::Remove{id});
    if (now) entries.emplace_back(scene::Create{id, *now});
}

void VersionLog::changed(const std::vector<scene::ObjectChange>& changes) {
    for (const scene::ObjectChange& change : changes) before_.try_emplace(change.id, change.before);
    unpublished_ = unpublished_ || !changes.empty();
}

Version VersionLog::pending() const {
    const Version version = published_.version();
    return {version.epoch, version.number + (unpublished_ ? 1 : 0)};
}

scene::ChangeList VersionLog::publish(scene::Scene& head) {
    scene::ChangeList list{
        .from = published_.version(), .to = pending(), .entries = {}, .state_hash = head.state_hash()};
    std::vector<TouchedObject> touched;
    for (const auto& [id, before] : before_) {
        const scene::Object* now = head.find(id);
        const auto was = kind_of(before.get());
        scene::FieldMask mask = ~scene::FieldMask{0};
        if (now && was == kind(*now)) mask = differing_fields(*before, *now);
        if (mask == 0 || (!was && !now)) continue;
        add_entries(id, was, mask, now, list.entries);
        touched.push_back({id, mask, was});
    }
    before_.clear();
    unpublished_ = false;
    head.set_version(list.to);
    published_.publish(head, std::move(touched));
    return list;
}

}  // namespace tessera::master
