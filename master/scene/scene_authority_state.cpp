#include "master/scene/scene_authority.h"

namespace tessera::master {

AuthorityState SceneAuthority::save() const {
    AuthorityState state{.scene = scene_,
                         .last_transaction = history_.last(),
                         .history = history_.all(),
                         .editors = {},
                         .writers = writers_};
    for (const auto& [number, editor] : editors_.all()) state.editors.push_back(editor);
    return state;
}

void SceneAuthority::restore(AuthorityState state) {
    const Version version = scene_.version();
    scene_ = std::move(state.scene);
    scene_.set_version(version);
    referrers_ = {};
    for (const auto& [id, object] : scene_.objects()) referrers_.replace(id, nullptr, object.get());
    editors_.clear();
    for (EditorRecord& editor : state.editors) editors_.restore(std::move(editor));
    history_.restore(state.last_transaction, std::move(state.history));
    writers_ = std::move(state.writers);
    locks_.clear();
    start_epoch();
}

void SceneAuthority::start_epoch() {
    scene_.set_version({scene_.version().epoch, 1});
    versions_ = VersionLog(scene_);
    editors_.answer_at(version());
}

Expected<void> SceneAuthority::replay(const wire::JournalRecord& record) {
    if (const auto* editor = std::get_if<wire::RecordedEditor>(&record)) {
        editors_.restore(restored(*editor));
    } else if (const auto* edit = std::get_if<RecordedEdit>(&record)) {
        return replay_edit(*edit);
    } else if (std::holds_alternative<wire::RecordedClose>(record)) {
        clear();
    }
    return {};
}

Expected<void> SceneAuthority::replay_edit(const RecordedEdit& recorded) {
    const std::string name = recorded.editor == 0
                                 ? "the render origin"
                                 : "edit " + std::to_string(recorded.sequence) + " of " + recorded.name;
    if (recorded.editor == 0) {
        const auto changes = scene::apply_and_observe(scene_, recorded.entries);
        if (!changes) return tl::unexpected(changes.error());
        index(*changes, Direction::Apply);
        versions_.changed(*changes);
    } else {
        EditorRecord* editor = editors_.by_number(recorded.editor);
        if (editor == nullptr)
            return failure(ErrorCode::InvalidInput, name + " is by an editor that never joined");
        const scene::Edit edit{.sequence = recorded.sequence,
                               .entries = recorded.undo ? std::vector<scene::Entry>() : recorded.entries,
                               .edit_group = recorded.edit_group,
                               .undo = recorded.undo};
        const Editor who{recorded.name, recorded.user, recorded.time};
        editor->last_sequence = recorded.sequence;
        editor->last_answer = edit.undo ? undo(*editor, edit, who) : change(*editor, edit, who);
        if (!editor->last_answer.accepted) {
            return failure(ErrorCode::InvalidInput,
                           name + " cannot be replayed: " + editor->last_answer.problems.at(0));
        }
        if (editor->last_answer.transaction != recorded.transaction)
            return failure(ErrorCode::InvalidInput, name + " has another transaction number than recorded");
    }
    if (scene_.state_hash() == recorded.state_hash) return {};
    return failure(ErrorCode::InvalidInput, "the scene after " + name + " differs from the recorded one");
}

}  // namespace tessera::master
