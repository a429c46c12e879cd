#include "client/edit/dry_run.h"

#include <functional>

#include "client/edit/script_error.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/validate.h"

namespace tessera::edit {
namespace {

constexpr std::size_t MaxLabelLength = 200;

std::string label_of(const std::vector<std::string>& texts) {
    std::string label = texts.empty() ? "" : texts.front().substr(0, MaxLabelLength);
    if (texts.size() > 1) label += " and " + std::to_string(texts.size() - 1) + " more";
    return label;
}

}  // namespace

DryRun::DryRun(EditTarget& target, Actions actions)
    : target_(target), actions_(actions), scene_(target.scene()), path_index_(scene_) {}

void DryRun::start_line(std::size_t line, std::string text) {
    line_ = line;
    text_ = std::move(text);
}

const scene::Scene& DryRun::scene() const {
    if (!is_known_) {
        throw ScriptError(
            1,
            "the scene after an undo or redo is not known before it is executed: move the following "
            "lines to a separate script");
    }
    return scene_;
}

void DryRun::apply(const std::vector<scene::Entry>& entries) {
    scene();
    for (const scene::Entry& entry : entries) {
        const auto place = scene_.objects().find(scene::id(entry));
        const bool is_there = place != scene_.objects().end();
        Touched& touched =
            touched_.try_emplace(scene::id(entry), Touched{is_there ? place->second : nullptr, 0})
                .first->second;
        touched.line = line_;
        if (is_there) path_index_.remove(place->first, *place->second);
        const auto applied = scene_.apply_entries({entry});
        if (const scene::Object* now = scene_.find(scene::id(entry))) path_index_.add(scene::id(entry), *now);
        if (!applied) throw ScriptError(1, applied.error().what());
    }
    if (entries.empty()) return;
    if (texts_.empty()) first_line_ = line_;
    texts_.push_back(text_);
}

void DryRun::add_blobs(const std::vector<scene::BlobPtr>& blobs) {
    blobs_.insert(blobs_.end(), blobs.begin(), blobs.end());
}

scene::BlobPtr DryRun::pending_blob(const Hash256& hash) const {
    for (const scene::BlobPtr& blob : blobs_) {
        if (blob->hash() == hash) return blob;
    }
    return nullptr;
}

void DryRun::print(std::string text) {
    add_action([text = std::move(text)](EditTarget&) -> Expected<std::string> { return text; });
}

void DryRun::add_action(std::function<Expected<std::string>(EditTarget&)> run) {
    const bool waits = actions_ == Actions::AtCommit && has_edits();
    (waits ? deferred_ : steps_).push_back(Action{line_, std::move(run)});
}

scene::FieldMask DryRun::uncommitted_fields(ObjectId id) const {
    const auto place = touched_.find(id);
    const scene::Object* now = scene_.find(id);
    if (actions_ == Actions::AtCommit || place == touched_.end() || now == nullptr) return 0;
    const auto& before = place->second.before;
    return before ? scene::differing_fields(*before, *now) : ~scene::FieldMask{0};
}

void DryRun::begin() {
    if (has_edits()) throw ScriptError(1, "a transaction is open: commit it or roll it back first");
    is_open_ = true;
}

std::vector<scene::Entry> DryRun::entries() const {
    std::vector<scene::Entry> entries;
    for (const auto& [id, touched] : touched_) {
        const scene::Object* now = scene_.find(id);
        if (now == nullptr) {
            if (touched.before) entries.emplace_back(scene::Remove{id});
        } else if (!touched.before) {
            entries.emplace_back(scene::Create{id, *now});
        } else if (const scene::FieldMask mask = scene::differing_fields(*touched.before, *now); mask != 0) {
            entries.emplace_back(scene::Update{id, mask, *now});
        }
    }
    return entries;
}

void DryRun::commit() {
    std::vector<scene::Entry> list = entries();
    if (!list.empty()) {
        const std::vector<scene::Problem> problems = scene::validate_entries(scene_, list);
        if (!problems.empty()) {
            const auto place = touched_.find(problems.front().id);
            throw ScriptError(place == touched_.end() ? line_ : place->second.line, 1,
                              problems.front().message);
        }
        steps_.push_back(Transaction{std::move(list), std::move(blobs_), label_of(texts_), first_line_});
    }
    for (Step& step : deferred_) steps_.push_back(std::move(step));
    deferred_.clear();
    touched_.clear();
    blobs_.clear();
    texts_.clear();
    is_open_ = false;
}

void DryRun::rollback() {
    for (const auto& [id, touched] : touched_) {
        if (const scene::Object* now = scene_.find(id)) {
            path_index_.remove(id, *now);
            (void)scene_.apply_entries({scene::Entry(scene::Remove{id})});
        }
        if (!touched.before) continue;
        path_index_.add(id, *touched.before);
        (void)scene_.apply_entries({scene::Entry(scene::Create{id, *touched.before})});
    }
    touched_.clear();
    commit();
}

void DryRun::mark_scene_unknown() {
    if (has_edits()) {
        throw ScriptError(1, "there are uncommitted edits: commit them or roll them back first");
    }
    if (actions_ == Actions::AtCommit) is_known_ = false;
}

void DryRun::sync_with_target() {
    if (has_edits() || scene_.state_hash() == target_.scene().state_hash()) return;
    scene_ = target_.scene();
    path_index_ = PathIndex(scene_);
}

std::vector<Step> DryRun::take_steps() {
    std::vector<Step> steps = std::move(steps_);
    steps_.clear();
    return steps;
}

}  // namespace tessera::edit
