#include "master/scene/version_log.h"

#include "mediator/scene/fields.h"

namespace tessera::master {

namespace {

// What leads from one state of an object to another. Null = not there.
void add_entries(ObjectId id, std::optional<scene::ObjectKind> was, scene::FieldMask mask,
                 const scene::Object* now, std::vector<scene::Entry>& entries) {
    if (was && now && *was == kind(*now)) {
        if (mask != 0) entries.push_back(scene::Update{id, mask, scene::copy_of_fields(*now, mask)});
        return;
    }
    if (was) entries.emplace_back(scene::Remove{id});
    if (now) entries.emplace_back(scene::Create{id, *now});
}

std::optional<scene::ObjectKind> kind_of(const scene::Object* object) {
    return object ? std::optional(kind(*object)) : std::nullopt;
}

}  // namespace

VersionLog::VersionLog(const scene::Scene& scene)
    : version_(scene.version()), state_hash_(scene.state_hash()) {}

void VersionLog::changed(const std::vector<scene::ObjectChange>& changes) {
    for (const scene::ObjectChange& change : changes) before_.try_emplace(change.id, change.before);
    unpublished_ = unpublished_ || !changes.empty();
}

scene::ChangeList VersionLog::publish(const scene::Scene& head) {
    scene::ChangeList list{.from = version_, .to = pending(), .entries = {}, .state_hash = head.state_hash()};
    std::vector<Touched> touched;
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
    version_ = list.to;
    state_hash_ = list.state_hash;
    log_size_ += touched.size();
    log_.push_back(std::move(touched));
    while (log_.size() > MaxVersions || log_size_ > MaxTouched) {
        log_size_ -= log_.front().size();
        log_.pop_front();
    }
    return list;
}

const scene::Object* VersionLog::published(ObjectId id, const scene::Scene& head) const {
    const auto it = before_.find(id);
    return it == before_.end() ? head.find(id) : it->second.get();
}

scene::ChangeList VersionLog::snapshot(const scene::Scene& head) const {
    scene::ChangeList list{
        .from = {version_.epoch, 0}, .to = version_, .entries = {}, .state_hash = state_hash_};
    for (const auto& [id, object] : head.objects()) {
        if (!before_.contains(id)) list.entries.emplace_back(scene::Create{id, *object});
    }
    for (const auto& [id, object] : before_) {
        if (object) list.entries.emplace_back(scene::Create{id, *object});
    }
    return list;
}

scene::Scene VersionLog::published(const scene::Scene& head) const {
    scene::Scene scene = head;
    std::vector<scene::Entry> entries;
    for (const auto& [id, object] : before_) {
        if (head.find(id)) entries.emplace_back(scene::Remove{id});
        if (object) entries.emplace_back(scene::Create{id, *object});
    }
    // Each removes what is there, or creates what is not: this cannot fail.
    if (auto applied = scene.apply_entries(entries); !applied) throw applied.error();
    scene.set_version(version_);
    return scene;
}

std::optional<scene::ChangeList> VersionLog::since(Version known, const scene::Scene& head) const {
    if (known.epoch != version_.epoch || known.number > version_.number ||
        version_.number - known.number > log_.size() || known.number == 0) {
        return std::nullopt;
    }
    std::map<ObjectId, Touched> touched;
    for (auto version = log_.end() - static_cast<std::ptrdiff_t>(version_.number - known.number);
         version != log_.end(); ++version) {
        for (const Touched& entry : *version) {
            const auto [it, fresh] = touched.try_emplace(entry.id, entry);
            if (!fresh) it->second.mask |= entry.mask;
        }
    }
    scene::ChangeList list{.from = known, .to = version_, .entries = {}, .state_hash = state_hash_};
    for (const auto& [id, entry] : touched) {
        const scene::Object* now = published(id, head);
        // Gone and there again: the mask says all.
        add_entries(id, entry.was, now ? entry.mask & all_fields(*now) : 0, now, list.entries);
    }
    return list;
}

}  // namespace tessera::master
