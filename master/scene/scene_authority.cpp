#include "master/scene/scene_authority.h"

#include <algorithm>
#include <cmath>

#include "master/scene/transaction_text.h"
#include "master/scene/undo_plan.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/scene_editor.h"
#include "mediator/scene/validate.h"
#include "mediator/scene/validate_object.h"

namespace tessera::master {

namespace {

constexpr std::size_t MaxProblems = 20;

std::string first_field(const scene::Update& update) {
    for (std::uint32_t field = 0; update.mask >> field != 0; ++field) {
        if ((update.mask >> field) & 1u) return std::string(field_name(kind(update.fields), field));
    }
    return "name";
}

// Why an entry is invalid: unknown or used ids, wrong kinds. Empty = valid.
std::string problem_of(const scene::Entry& entry, const scene::Object* present, const IdRange& ids) {
    const std::string number = std::to_string(scene::id(entry).value);
    if (const auto* create = std::get_if<scene::Create>(&entry)) {
        if (present != nullptr) return describe(create->id, *present) + " exists already: choose another id";
        if (ids.contains(create->id)) return {};
        return describe(create->id, create->object) +
               " is outside the id range allocated to this session: use an id in " +
               std::to_string(ids.first) + " .. " + std::to_string(ids.first + ids.count - 1);
    }
    if (const auto* update = std::get_if<scene::Update>(&entry)) {
        const std::string wanted = name(kind(update->fields));
        if (present == nullptr) {
            return "there is no " + wanted + " " + number + ": its " + first_field(*update) +
                   " cannot be set; read the scene again";
        }
        if (present->index() == update->fields.index()) return {};
        return describe(update->id, *present) + " is no " + wanted + ": its " + first_field(*update) +
               " cannot be set";
    }
    if (present == nullptr) return "there is no object " + number + ": it cannot be removed";
    if (scene::id(entry) == scene::RootId) return "the root cannot be removed: remove its children";
    return {};
}

}  // namespace

struct SceneAuthority::Request {
    std::vector<scene::Entry> entries;
    Nature nature = Nature::Edit;
    std::uint64_t target = 0;
    std::map<ObjectId, ObjectWriters> brought_back;
    std::vector<std::string> notes;
    std::string text;  // of an undo
    Writer author;
};

SceneAuthority::SceneAuthority(std::uint64_t epoch, std::shared_ptr<scene::BlobStore> blobs)
    : blobs_(std::move(blobs)),
      scene_([&] {
          scene::Scene scene;
          (void)scene.apply_entries({scene::Create{scene::RootId, scene::Root{}}});
          scene.set_version({epoch, 1});
          return scene;
      }()),
      versions_(scene_) {}

SceneAuthority::IdRange SceneAuthority::join(SessionId session, const std::string& user, std::uint64_t key) {
    const EditorRecord* before = editors_.of(session);
    const EditorRecord* editor = editors_.join(session, user, key, scene_);
    if (editor == nullptr) return {};
    if (recorder_ && editor != before && !recorder_->joined(recorded(*editor))) {
        editors_.leave(session);
        return {};
    }
    return editor->ids;
}

std::uint64_t SceneAuthority::last_sequence(SessionId session) const {
    const EditorRecord* editor = editors_.of(session);
    return editor ? editor->last_sequence : 0;
}

void SceneAuthority::forget(SessionId session) {
    editors_.leave(session);
    locks_.release_all(session);
}

std::vector<scene::BlobRef> SceneAuthority::missing_blobs(const scene::Edit& edit) const {
    std::vector<scene::BlobRef> missing;
    for (const scene::Entry& entry : edit.entries) {
        for (const scene::BlobRef& blob : scene::referenced_blobs(entry)) {
            if (!blob.empty() && !blobs_->find(blob.hash)) missing.push_back(blob);
        }
    }
    return missing;
}

// An edit that extends the transaction of its group may have to copy it, if a checkpoint still holds it; and the oldest
// transaction may go.
std::size_t SceneAuthority::size_of(const scene::Edit& edit) const {
    std::size_t size = edit.entries.size();
    if (history_.all().size() == EditHistory::Length) size += history_.all().front().changes.all().size();
    const EditorRecord* editor = editors_.of(edit.session);
    if (editor == nullptr) return size;
    std::uint64_t number = edit.undo;
    if (number == scene::UndoLatest) number = history_.latest_to_undo(editor->number);
    if (number == scene::RedoLatest) number = history_.latest_to_redo(editor->number);
    if (number == 0 && edit.edit_group != 0 && edit.edit_group == editor->edit_group)
        number = editor->edit_group_transaction;
    if (const Transaction* transaction = history_.find(number)) size += transaction->changes.all().size();
    return size;
}

std::optional<std::string> SceneAuthority::order_problem(const EditorRecord& editor,
                                                         std::uint64_t sequence) const {
    const std::string number = "edit " + std::to_string(sequence);
    const std::string last = std::to_string(editor.last_sequence);
    if (sequence < editor.last_sequence || sequence == 0)
        return number + " is older than " + last + ", the last one of this editor: it is not applied again";
    if (sequence > editor.last_sequence + 1 && !editor.may_skip)
        return number + " came out of order: expected " + std::to_string(editor.last_sequence + 1);
    return std::nullopt;
}

SceneAuthority::Answer SceneAuthority::submit(const scene::Edit& edit, const Editor& who) {
    EditorRecord* editor = editors_.of(edit.session);
    if (editor == nullptr) {
        return {.version = version(),
                .problems = {"the session has no open scene, or its editor is connected elsewhere: "
                             "open one first"}};
    }
    if (edit.sequence == editor->last_sequence && edit.sequence != 0) return editor->last_answer;
    if (const auto problem = order_problem(*editor, edit.sequence))
        return {.version = version(), .problems = {*problem}};
    editor->last_sequence = edit.sequence;
    editor->may_skip = false;
    return editor->last_answer = edit.undo != 0 ? undo(*editor, edit, who) : change(*editor, edit, who);
}

void SceneAuthority::refused(SessionId session, std::uint64_t sequence, std::string problem) {
    EditorRecord* editor = editors_.of(session);
    if (editor == nullptr || sequence <= editor->last_sequence || order_problem(*editor, sequence)) return;
    editor->last_sequence = sequence;
    editor->may_skip = false;
    editor->last_answer = {.version = version(), .problems = {std::move(problem)}};
}

SceneAuthority::Answer SceneAuthority::change(EditorRecord& editor, const scene::Edit& edit,
                                              const Editor& who) {
    Answer answer{.version = version()};
    scene::SceneEditor draft(scene_);
    for (const scene::Entry& entry : edit.entries) {
        std::string problem = problem_of(entry, draft.find(scene::id(entry)), editor.ids);
        if (problem.empty()) {
            draft.apply(entry);
        } else if (answer.problems.size() < MaxProblems) {
            answer.problems.push_back(std::move(problem));
        }
    }
    if (!answer.problems.empty()) return answer;
    Request request{.entries = draft.take()};
    if (request.entries.empty()) return {.accepted = true, .version = pending()};
    request.author = {.name = who.name, .user = who.user, .time = who.time};
    return carry_out(editor, edit, request);
}

SceneAuthority::Answer SceneAuthority::undo(EditorRecord& editor, const scene::Edit& edit,
                                            const Editor& who) {
    const auto refuse = [&](std::string problem) {
        return Answer{.version = version(), .problems = {std::move(problem)}};
    };
    if (!edit.entries.empty()) return refuse("an undo cannot contain entries: send them as a separate edit");
    std::uint64_t number = edit.undo;
    if (number == scene::UndoLatest) number = history_.latest_to_undo(editor.number);
    if (number == scene::RedoLatest) number = history_.latest_to_redo(editor.number);
    if (number == 0) {
        return refuse(edit.undo == scene::UndoLatest ? "this editor has nothing left to undo"
                                                     : "this editor has nothing to redo");
    }
    const Transaction* target = history_.find(number);
    if (target == nullptr) {
        return refuse("transaction " + std::to_string(number) + " is not among the last " +
                      std::to_string(EditHistory::Length) + ": it cannot be undone");
    }
    if (target->undone_by != 0) {
        return refuse("transaction " + std::to_string(number) + " was undone by " +
                      std::to_string(target->undone_by) + ": undo that to have it back");
    }
    Request request{.nature = target->nature == Nature::Undo ? Nature::Redo : Nature::Undo, .target = number};
    request.author = {history_.last() + 1, who.name, who.user, who.time};
    UndoPlan plan =
        plan_undo(*target, scene_, writers_, history_, std::make_shared<const Writer>(request.author));
    request.entries = std::move(plan.entries);
    request.brought_back = std::move(plan.writers);
    request.notes = std::move(plan.notes);
    const Transaction* origin = target;
    while (const Transaction* earlier = history_.find(origin->undoes)) origin = earlier;
    request.text = (request.nature == Nature::Redo ? "redid " : "undid ") + std::to_string(origin->number) +
                   ": " + origin->text;
    return carry_out(editor, edit, request);
}

std::vector<SceneAuthority::Withdrawn> SceneAuthority::withdraw(std::uint64_t built, std::uint64_t published,
                                                                const Editor& by) {
    std::vector<Withdrawn> withdrawn;
    for (std::uint64_t number = published; number > built; --number) {
        const Transaction* target = history_.find(number);
        if (target == nullptr || target->undone_by != 0) continue;
        EditorRecord* editor = editors_.by_number(target->editor);
        if (editor == nullptr) continue;
        Withdrawn entry{number, editor->session, target->text};
        // Not one of the author's own edits: their sequence and last answer stay.
        const scene::Edit edit{.session = editor->session, .sequence = editor->last_sequence, .undo = number};
        if (undo(*editor, edit, by).accepted) withdrawn.push_back(std::move(entry));
    }
    return withdrawn;
}

std::vector<std::string> SceneAuthority::locks_problems(const EditorRecord& editor,
                                                        const std::vector<scene::Entry>& entries) const {
    std::vector<std::string> problems;
    for (const scene::Entry& entry : entries) {
        const std::string* holder = locks_.held_by_other(scene::id(entry), editor.session);
        if (holder == nullptr || problems.size() == MaxProblems) continue;
        problems.push_back(describe(scene::id(entry), *scene_.find(scene::id(entry))) + " is locked by " +
                           *holder + ": ask them for it");
    }
    return problems;
}

void SceneAuthority::index(const std::vector<scene::ObjectChange>& changes, Direction direction) {
    for (const scene::ObjectChange& change : changes) {
        if (change.is_update() && (change.mask & scene::reference_fields(kind(*change.after))) == 0) continue;
        const scene::Object *from = change.before.get(), *to = change.after.get();
        if (direction == Direction::Revert) std::swap(from, to);
        referrers_.replace(change.id, from, to);
    }
    graph_size_.changed(changes, referrers_);
}

std::vector<std::string> SceneAuthority::problems_after(const std::vector<scene::ObjectChange>& changes) {
    std::vector<std::string> problems;
    for (const scene::Problem& problem : scene::validate_changes(scene_, referrers_, changes)) {
        if (problems.size() < MaxProblems) problems.push_back(problem.message);
    }
    if (!problems.empty()) return problems;
    if (const Expected<void> counted = graph_size_.count(scene_); !counted)
        problems.push_back(counted.error().what());
    return problems;
}

void SceneAuthority::take_back(const std::vector<scene::ObjectChange>& changes) {
    if (auto applied = scene_.apply_entries(scene::inverse(changes)); !applied) throw applied.error();
    index(changes, Direction::Revert);
}

// Nodes check the sizes that they fetch: a wrong one would keep them waiting for ever.
std::vector<std::string> SceneAuthority::blob_problems(const std::vector<scene::Entry>& entries) const {
    std::vector<std::string> problems;
    for (const scene::Entry& entry : entries) {
        for (const scene::BlobRef& reference : scene::referenced_blobs(entry)) {
            const scene::BlobPtr blob = reference.empty() ? nullptr : blobs_->find(reference.hash);
            if (!blob || blob->bytes().size() == reference.byte_size || problems.size() == MaxProblems)
                continue;
            problems.push_back("object " + std::to_string(scene::id(entry).value) + ": blob " +
                               to_hex(reference.hash).substr(0, 12) + " has " +
                               std::to_string(blob->bytes().size()) + " bytes, not " +
                               std::to_string(reference.byte_size) + " as its reference says");
        }
    }
    return problems;
}

SceneAuthority::Answer SceneAuthority::carry_out(EditorRecord& editor, const scene::Edit& edit,
                                                 const Request& request) {
    Answer answer{.version = version(), .problems = locks_problems(editor, request.entries)};
    if (answer.problems.empty()) answer.problems = blob_problems(request.entries);
    if (!answer.problems.empty()) return answer;
    const auto changes = scene::apply_and_observe(scene_, request.entries);
    if (!changes) {
        answer.problems.push_back(changes.error().what());
        return answer;
    }
    index(*changes, Direction::Apply);
    answer.problems = problems_after(*changes);
    Transaction* open = open_transaction(editor, edit, *changes);
    const std::uint64_t number = open ? open->number : history_.last() + 1;
    if (answer.problems.empty() && recorder_) {
        const auto kept = recorder_->edited({.editor = editor.number,
                                             .sequence = edit.sequence,
                                             .edit_group = edit.edit_group,
                                             .undo = request.target,
                                             .name = request.author.name,
                                             .user = request.author.user,
                                             .time = request.author.time,
                                             .entries = request.entries,
                                             .transaction = number,
                                             .state_hash = scene_.state_hash(),
                                             .text = request.target ? request.text : summary(*changes)});
        if (!kept) answer.problems.push_back(kept.error().what());
    }
    if (!answer.problems.empty()) {
        take_back(*changes);
        return answer;
    }
    commit(editor, edit, request, *changes, open);
    return {.accepted = true, .version = pending(), .transaction = number, .notes = request.notes};
}

Transaction* SceneAuthority::open_transaction(const EditorRecord& editor, const scene::Edit& edit,
                                              const std::vector<scene::ObjectChange>& changes) {
    if (edit.edit_group == 0 || edit.undo != 0 || edit.edit_group != editor.edit_group) return nullptr;
    Transaction* open = history_.find(editor.edit_group_transaction);
    const bool goes_on = open && open->undone_by == 0 && can_extend(*open, changes, writers_);
    return goes_on ? open : nullptr;
}

void SceneAuthority::commit(EditorRecord& editor, const scene::Edit& edit, const Request& request,
                            const std::vector<scene::ObjectChange>& changes, Transaction* open) {
    Transaction* transaction = open;
    if (open == nullptr) {
        Transaction fresh{.editor = editor.number, .nature = request.nature, .edit_group = edit.edit_group};
        fresh.undoes = request.target;
        transaction = &history_.add(std::move(fresh));
    } else {
        ++open->edits;
    }
    Writer author = request.author;
    author.transaction = transaction->number;
    transaction->author = std::make_shared<const Writer>(std::move(author));
    if (request.target == 0) {
        extend(*transaction, changes, writers_);
        transaction->text = summary(*transaction);
    } else {
        record_undo(*transaction, changes, request.brought_back, scene_, writers_);
        transaction->text = request.text;
        if (Transaction* target = history_.find(request.target))
            history_.mark_undone(*target, transaction->number);
    }
    editor.edit_group = request.target == 0 ? edit.edit_group : 0;
    editor.edit_group_transaction = transaction->number;
    for (const scene::ObjectChange& change : changes) {
        if (!change.after) locks_.object_gone(change.id);
    }
    versions_.changed(changes);
}

std::optional<scene::ChangeList> SceneAuthority::publish() {
    if (!has_unpublished()) return std::nullopt;
    return versions_.publish(scene_);
}

bool SceneAuthority::is_near_origin(const glm::dvec3& camera_position) const {
    const auto* root = scene_.find_as<scene::Root>(scene::RootId);
    const glm::dvec3 offset = glm::abs(camera_position - root->render_origin);
    return offset.x <= RenderOriginCell && offset.y <= RenderOriginCell && offset.z <= RenderOriginCell;
}

std::optional<scene::ChangeList> SceneAuthority::follow_camera(const glm::dvec3& camera_position) {
    if (is_near_origin(camera_position)) return {};
    scene::Root moved;
    moved.render_origin = glm::round(camera_position / RenderOriginCell) * RenderOriginCell;
    const std::vector<scene::Entry> entries{
        scene::Update{scene::RootId, scene::Fields<scene::Root>(&scene::Root::render_origin).bits(), moved}};
    const auto changes = scene::apply_and_observe(scene_, entries);
    if (!changes) throw changes.error();
    if (recorder_ && !recorder_->edited({.entries = entries, .state_hash = scene_.state_hash()})) {
        take_back(*changes);
        return {};
    }
    versions_.changed(*changes);
    return publish();
}

std::optional<scene::ChangeList> SceneAuthority::clear() {
    scene::Scene empty;
    (void)empty.apply_entries({scene::Create{scene::RootId, scene::Root{}}});
    const auto changes = scene::apply_and_observe(scene_, scene::difference(scene_, empty).entries);
    if (!changes) throw changes.error();
    index(*changes, Direction::Apply);
    versions_.changed(*changes);
    editors_.clear();  // ids are part of a frame's bits: the same scene again gets the same ones
    locks_.clear();
    history_.clear();
    writers_.clear();
    blobs_->erase_unused();
    if (recorder_) recorder_->cleared();
    return publish();
}

std::vector<std::string> SceneAuthority::lock(SessionId session, const std::string& name,
                                              const std::vector<ObjectId>& objects) {
    return locks_.lock(session, name, objects, scene_);
}

std::vector<session::TransactionSummary> SceneAuthority::history(std::size_t count) const {
    std::vector<session::TransactionSummary> list;
    const auto& all = history_.all();
    for (auto entry = all.rbegin(); entry != all.rend() && list.size() < count; ++entry) {
        list.push_back({.number = entry->number,
                        .name = entry->author->name,
                        .user = entry->author->user,
                        .time = entry->author->time,
                        .edits = entry->edits,
                        .text = entry->text,
                        .undoes = entry->undoes,
                        .undone_by = entry->undone_by});
    }
    return list;
}

std::vector<session::FieldWriter> SceneAuthority::writers(ObjectId object) const {
    std::vector<session::FieldWriter> list;
    for (const auto& [field, writer] : writers_.of(object))
        list.push_back({field, writer->transaction, writer->name, writer->user, writer->time});
    return list;
}

}  // namespace tessera::master
