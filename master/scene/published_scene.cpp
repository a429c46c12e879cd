#include "master/scene/published_scene.h"

#include <map>

#include "master/scene/version_log.h"
#include "mediator/scene/fields.h"

namespace tessera::master {

MissedChanges::MissedChanges(Version from, scene::Scene scene, std::vector<TouchedObjects> versions)
    : from_(from), scene_(std::move(scene)), versions_(std::move(versions)) {
    // An object of another kind is removed and created.
    for (const TouchedObjects& version : versions_) size_ += 2 * version->size();
}

scene::ChangeList MissedChanges::list() const {
    std::map<ObjectId, TouchedObject> touched;
    for (const TouchedObjects& version : versions_) {
        for (const TouchedObject& entry : *version) {
            const auto [it, fresh] = touched.try_emplace(entry.id, entry);
            if (!fresh) it->second.mask |= entry.mask;
        }
    }
    scene::ChangeList list{
        .from = from_, .to = scene_.version(), .entries = {}, .state_hash = scene_.state_hash()};
    for (const auto& [id, entry] : touched) {
        const scene::Object* now = scene_.find(id);
        // Removed and created again: the mask has all fields.
        add_entries(id, entry.was, now ? entry.mask & scene::all_fields(*now) : 0, now, list.entries);
    }
    return list;
}

void PublishedScene::publish(scene::Scene scene, std::vector<TouchedObject> touched) {
    scene_ = std::move(scene);
    log_size_ += touched.size();
    log_.push_back(std::make_shared<const std::vector<TouchedObject>>(std::move(touched)));
    while (log_.size() > MaxVersions || log_size_ > MaxTouched) {
        log_size_ -= log_.front()->size();
        log_.pop_front();
    }
}

std::optional<MissedChanges> PublishedScene::since(Version known) const {
    const Version now = version();
    if (known.epoch != now.epoch || known.number > now.number || now.number - known.number > log_.size() ||
        known.number == 0) {
        return std::nullopt;
    }
    const auto first = log_.end() - static_cast<std::ptrdiff_t>(now.number - known.number);
    return MissedChanges(known, scene_, {first, log_.end()});
}

}  // namespace tessera::master
