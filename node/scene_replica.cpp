#include "node/scene_replica.h"

#include <algorithm>
#include <map>
#include <set>

#include "mediator/wire/envelope.h"

namespace tessera::node {

namespace {

constexpr std::size_t MaxListsUnderWay = 4096;

}  // namespace

void SceneReplica::start_epoch(std::uint64_t epoch) {
    if (epoch == epoch_) return;
    epoch_ = epoch;
    scene_ = {};
    announced_ = built_ = {};
    built_hash_ = {};
    announced_lists_.clear();
    applied_lists_.clear();
    building_target_.reset();  // the current build is of the old epoch
    awaits_snapshot_ = scene_lost_ = false;
}

SceneReplica::CheckResult SceneReplica::check(Version from, Version to) const {
    if (to.epoch != epoch_ || to.number == 0) return CheckResult::Gap;
    if (to.number < announced_.number) return CheckResult::Duplicate;
    if (from.number == 0) {
        return to.number > announced_.number || scene_lost_ ? CheckResult::Accepted : CheckResult::Duplicate;
    }
    if (to.number == announced_.number && !scene_lost_) return CheckResult::Duplicate;
    const bool follows = from == announced_ && to.number == from.number + 1;
    return follows && !awaits_snapshot_ ? CheckResult::Accepted : CheckResult::Gap;
}

SceneReplica::CheckResult SceneReplica::announce(Announced item) {
    const CheckResult result = check(item.from, item.to);
    const bool snapshot = item.from.number == 0;
    if (snapshot && result != CheckResult::Gap)
        awaits_snapshot_ = scene_lost_ && result == CheckResult::Duplicate;
    if (result != CheckResult::Accepted) return result;
    if (snapshot) {  // supersedes everything before it
        announced_lists_.clear();
        applied_lists_.clear();
        scene_lost_ = false;
    } else if (announced_lists_.size() + applied_lists_.size() >= MaxListsUnderWay) {
        return CheckResult::Gap;
    }
    announced_ = item.to;
    announced_lists_.push_back(std::move(item));
    return CheckResult::Accepted;
}

SceneReplica::CheckResult SceneReplica::receive(scene::ChangeList list) {
    const Version from = list.from, to = list.to;
    return announce({from, to, std::move(list)});
}

SceneReplica::CheckResult SceneReplica::receive(const wire::ChangesByBlob& announced) {
    return announce({announced.from, announced.to, announced.blob});
}

Expected<void> SceneReplica::advance() {
    while (!announced_lists_.empty()) {
        Announced& item = announced_lists_.front();
        Expected<scene::ChangeList> list = scene::ChangeList{};
        if (auto* here = std::get_if<scene::ChangeList>(&item.content)) {
            list = std::move(*here);
        } else {
            const scene::BlobPtr blob = blobs_->find(std::get<scene::BlobRef>(item.content).hash);
            if (!blob) break;
            list = wire::decode_change_list(blob->bytes());
            if (list && (list->from.number != item.from.number || list->to != item.to)) {
                list = failure(ErrorCode::InvalidInput,
                               "the change list has other versions than were announced");
            }
        }
        refused_ = item.to;
        announced_lists_.pop_front();
        Expected<void> done = list ? apply(std::move(*list)) : tl::unexpected(list.error());
        if (!done) {
            discard();
            return done;
        }
    }
    return {};
}

Expected<void> SceneReplica::apply(scene::ChangeList list) {
    if (Expected<void> done = scene_.apply(list); !done) return done;
    Applied applied;
    for (const scene::Entry& entry : list.entries) {
        const scene::Object* object = scene_.find(scene::id(entry));
        if (object && std::holds_alternative<scene::Transform>(*object))
            continue;  // the most frequent kind, without blobs
        applied.objects.emplace_back(
            scene::id(entry), object ? scene::referenced_blobs(*object) : std::vector<scene::BlobRef>());
    }
    applied.step = {std::move(list), scene_};
    applied_lists_.push_back(std::move(applied));
    return {};
}

std::vector<scene::BlobRef> SceneReplica::missing() const {
    std::set<scene::BlobRef> missing;
    for (const Announced& item : announced_lists_) {
        const auto* blob = std::get_if<scene::BlobRef>(&item.content);
        if (blob && !here(*blob)) missing.insert(*blob);
    }
    std::map<ObjectId, const std::vector<scene::BlobRef>*> last;
    for (const Applied& applied : applied_lists_) {
        for (const auto& [id, blobs] : applied.objects) last[id] = &blobs;
    }
    for (const auto& [id, blobs] : last) {
        for (const scene::BlobRef& blob : *blobs) {
            if (!here(blob)) missing.insert(blob);
        }
    }
    return {missing.begin(), missing.end()};
}

bool SceneReplica::awaits_list(const Hash256& hash) const {
    return std::any_of(announced_lists_.begin(), announced_lists_.end(), [&](const Announced& item) {
        const auto* blob = std::get_if<scene::BlobRef>(&item.content);
        return blob && blob->hash == hash;
    });
}

// How many of the applied lists, from the first, give a scene whose blobs are all in the store.
std::size_t SceneReplica::buildable() const {
    std::size_t count = 0, lacking = 0;
    std::map<ObjectId, bool> lacks;
    for (std::size_t i = 0; i < applied_lists_.size(); ++i) {
        for (const auto& [id, blobs] : applied_lists_[i].objects) {
            bool& before = lacks[id];
            const bool now =
                !std::all_of(blobs.begin(), blobs.end(), [&](const auto& blob) { return here(blob); });
            lacking = lacking - (before ? 1 : 0) + (now ? 1 : 0);
            before = now;
        }
        if (lacking == 0) count = i + 1;
    }
    return count;
}

std::optional<SceneReplica::Build> SceneReplica::take_build() {
    if (building_) return std::nullopt;
    Build build;
    std::set<ObjectId> touched;
    for (std::size_t count = buildable(); count > 0; --count) {
        Applied& applied = applied_lists_.front();
        for (const scene::Entry& entry : applied.step.list.entries) {
            if (!std::holds_alternative<scene::Remove>(entry)) touched.insert(scene::id(entry));
        }
        build.steps.push_back(std::move(applied.step));
        applied_lists_.pop_front();
    }
    if (build.steps.empty()) return std::nullopt;
    for (const ObjectId id : touched) {
        const scene::Object* object = build.scene().find(id);
        if (!object) continue;
        const std::vector<scene::BlobRef> blobs = scene::referenced_blobs(*object);
        const bool all_here =
            std::all_of(blobs.begin(), blobs.end(), [&](const auto& blob) { return here(blob); });
        if (!blobs.empty() && all_here) build.unchecked.push_back(id);
    }
    building_ = true;
    building_target_.emplace(build.scene().version(), build.scene().state_hash());
    return build;
}

bool SceneReplica::built() {
    building_ = false;
    if (!building_target_) return false;
    built_ = building_target_->first;
    built_hash_ = building_target_->second;
    building_target_.reset();
    return true;
}

bool SceneReplica::rejected() {
    building_ = false;
    if (!building_target_) return false;
    discard();
    building_target_.reset();
    return true;
}

void SceneReplica::discard() {
    announced_lists_.clear();
    applied_lists_.clear();
    scene_ = {};
    scene_lost_ = true;
    announced_ = building_target_ ? building_target_->first : built_;
    await_snapshot();
}

void SceneReplica::await_snapshot() {
    awaits_snapshot_ = true;
}

}  // namespace tessera::node
