#include "master/scene_authority.h"

#include <cmath>

#include "mediator/scene/scene_editor.h"
#include "mediator/scene/validate.h"

namespace tessera::master {

namespace {

constexpr std::uint64_t FirstLentId = 1u << 16;
constexpr std::uint64_t IdsPerSession = 1u << 24;
constexpr std::uint64_t IdLimit = std::uint64_t{1} << 32;  // an object index must fit a film plane
constexpr std::size_t MaxProblems = 20;

std::vector<scene::BlobRef> blobs_of(const scene::Entry& entry) {
    if (const auto* create = std::get_if<scene::Create>(&entry))
        return scene::referenced_blobs(create->object);
    if (const auto* update = std::get_if<scene::Update>(&entry))
        return scene::referenced_blobs(update->fields);
    return {};
}

}  // namespace

SceneAuthority::SceneAuthority(std::uint64_t epoch, std::shared_ptr<scene::BlobStore> blobs)
    : blobs_(std::move(blobs)), next_id_(FirstLentId) {
    (void)scene_.apply_entries({scene::Create{scene::RootId, scene::Root{}}});
    scene_.set_version({epoch, 1});
}

SceneAuthority::IdRange SceneAuthority::lend_ids(SessionId session) {
    const auto [place, fresh] = sessions_.try_emplace(session);
    if (!fresh) return place->second.ids;
    if (next_id_ + IdsPerSession > IdLimit) next_id_ = FirstLentId;  // clashes are refused by create
    place->second.ids = {next_id_, IdsPerSession};
    next_id_ += IdsPerSession;
    return place->second.ids;
}

std::vector<scene::BlobRef> SceneAuthority::missing_blobs(const scene::Edit& edit) const {
    std::vector<scene::BlobRef> missing;
    for (const scene::Entry& entry : edit.entries) {
        for (const scene::BlobRef& blob : blobs_of(entry)) {
            if (!blob.empty() && !blobs_->find(blob.hash)) missing.push_back(blob);
        }
    }
    return missing;
}

SceneAuthority::Answer SceneAuthority::submit(const scene::Edit& edit) {
    const auto session = sessions_.find(edit.session);
    if (session == sessions_.end()) {
        return {.version = version(), .problems = {"the session has not opened a scene: open one first"}};
    }
    SessionState& state = session->second;
    if (edit.sequence == state.last_sequence) return state.last_answer;
    Answer answer{.version = version()};
    if (edit.sequence != state.last_sequence + 1) {
        answer.problems.push_back("edit " + std::to_string(edit.sequence) + " came out of order: expected " +
                                  std::to_string(state.last_sequence + 1));
        return answer;
    }
    state.last_sequence = edit.sequence;
    scene::SceneEditor editor(scene_);
    try {
        for (const scene::Entry& entry : edit.entries) {
            if (const auto* create = std::get_if<scene::Create>(&entry);
                create && !state.ids.contains(create->id)) {
                throw Error(ErrorCode::Refused, "object " + std::to_string(create->id.value) +
                                                    " lies outside the ids lent to this session");
            }
            if (scene::id(entry) == scene::RootId && std::holds_alternative<scene::Remove>(entry)) {
                throw Error(ErrorCode::Refused, "the root cannot be removed: remove its children");
            }
            editor.apply(entry);
        }
    } catch (const Error& error) {
        answer.problems.push_back(error.what());
        return state.last_answer = answer;
    }
    const std::vector<scene::Entry> entries = editor.take();
    scene::Scene next = scene_;
    if (auto applied = next.apply_entries(entries); !applied) {
        answer.problems.push_back(applied.error().what());
        return state.last_answer = answer;
    }
    for (const scene::Problem& problem : scene::validate_entries(next, entries)) {
        if (answer.problems.size() < MaxProblems) answer.problems.push_back(problem.message);
    }
    if (!answer.problems.empty()) return state.last_answer = answer;
    answer.accepted = true;
    answer.changes = advance(entries);
    answer.version = version();
    state.last_answer = answer;
    state.last_answer.changes.reset();
    return answer;
}

std::optional<scene::ChangeList> SceneAuthority::advance(std::vector<scene::Entry> entries) {
    if (entries.empty()) return std::nullopt;
    scene::ChangeList changes{
        .from = version(), .to = version(), .entries = std::move(entries), .state_hash = {}};
    ++changes.to.number;
    if (auto applied = scene_.apply_entries(changes.entries); !applied) throw applied.error();
    scene_.set_version(changes.to);
    changes.state_hash = scene_.state_hash();
    return changes;
}

std::optional<scene::ChangeList> SceneAuthority::clear() {
    scene::Scene empty;
    (void)empty.apply_entries({scene::Create{scene::RootId, scene::Root{}}});
    auto cleared = advance(scene::difference(scene_, empty).entries);
    next_id_ = FirstLentId;  // ids are part of a frame's bits: the same scene again gets the same ones
    blobs_->erase_unused();
    return cleared;
}

std::optional<scene::ChangeList> SceneAuthority::follow_camera(const glm::dvec3& camera_position) {
    const auto* root = scene_.find_as<scene::Root>(scene::RootId);
    const glm::dvec3 offset = glm::abs(camera_position - root->render_origin);
    if (offset.x <= RenderOriginCell && offset.y <= RenderOriginCell && offset.z <= RenderOriginCell)
        return {};
    scene::Root moved;
    moved.render_origin = glm::round(camera_position / RenderOriginCell) * RenderOriginCell;
    scene::SceneEditor editor(scene_);
    editor.update(scene::RootId, scene::Fields<scene::Root>(scene::Root::Field::RenderOrigin), moved);
    return advance(editor.take());
}

void SceneAuthority::forget(SessionId session) {
    sessions_.erase(session);
}

}  // namespace tessera::master
