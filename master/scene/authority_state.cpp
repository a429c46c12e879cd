#include "master/scene/authority_state.h"

#include <map>

#include "mediator/scene/validate.h"

namespace tessera::master {

namespace {

// Stores each writer once: many fields share one.
class WriterList {
  public:
    std::uint64_t number(const WriterPtr& writer) {
        if (!writer) return 0;
        const auto [it, fresh] = numbers_.try_emplace(writer, list_.size() + 1);
        if (fresh) list_.push_back({writer->transaction, writer->name, writer->user, writer->time});
        return it->second;
    }
    std::vector<wire::RecordedFieldWriter> fields(const ObjectWriters& writers) {
        std::vector<wire::RecordedFieldWriter> list;
        for (const auto& [field, writer] : writers) list.push_back({field, number(writer)});
        return list;
    }
    std::vector<wire::RecordedWriter> take() { return std::move(list_); }

  private:
    std::map<WriterPtr, std::uint64_t> numbers_;
    std::vector<wire::RecordedWriter> list_;
};

std::optional<scene::Object> value(const std::shared_ptr<const scene::Object>& object) {
    return object ? std::optional(*object) : std::nullopt;
}

std::shared_ptr<const scene::Object> shared(std::optional<scene::Object>& object) {
    return object ? std::make_shared<const scene::Object>(std::move(*object)) : nullptr;
}

ObjectWriters restored(const std::vector<wire::RecordedFieldWriter>& fields,
                       const std::vector<WriterPtr>& writers) {
    ObjectWriters result;
    for (const auto& [field, writer] : fields) result[field] = writer ? writers[writer - 1] : nullptr;
    return result;
}

wire::RecordedTransaction recorded(const Transaction& transaction, WriterList& writers) {
    wire::RecordedTransaction to{.number = transaction.number,
                                 .editor = transaction.editor,
                                 .nature = static_cast<std::uint32_t>(transaction.nature),
                                 .author = writers.number(transaction.author),
                                 .edit_group = transaction.edit_group,
                                 .edits = transaction.edits,
                                 .undoes = transaction.undoes,
                                 .undone_by = transaction.undone_by,
                                 .text = transaction.text,
                                 .changes = {}};
    for (const auto& [id, change] : transaction.changes.all()) {
        to.changes.push_back({.object = id,
                              .mask = change.object.mask,
                              .before = value(change.object.before),
                              .after = value(change.object.after),
                              .writers_before = writers.fields(change.writers_before),
                              .writers_after = writers.fields(change.writers_after)});
    }
    return to;
}

Transaction restored(wire::RecordedTransaction& from, const std::vector<WriterPtr>& writers) {
    Transaction transaction;
    transaction.number = from.number;
    transaction.editor = from.editor;
    transaction.nature = static_cast<Nature>(std::min(from.nature, 2u));
    transaction.author = writers[from.author - 1];
    transaction.edit_group = from.edit_group;
    transaction.edits = from.edits;
    transaction.undoes = from.undoes;
    transaction.undone_by = from.undone_by;
    transaction.text = std::move(from.text);
    TransactionChanges::Map& changes = transaction.changes.to_change();
    for (wire::RecordedChange& change : from.changes) {
        TransactionChange& to = changes[change.object];
        to.object = {change.object, change.mask, shared(change.before), shared(change.after)};
        to.writers_before = restored(change.writers_before, writers);
        to.writers_after = restored(change.writers_after, writers);
    }
    return transaction;
}

}  // namespace

wire::RecordedEditor recorded(const EditorRecord& editor) {
    return {.number = editor.number,
            .user = editor.user,
            .key = editor.key,
            .first_id = editor.ids.first,
            .id_count = editor.ids.count,
            .last_sequence = editor.last_sequence,
            .accepted = editor.last_answer.accepted,
            .problems = editor.last_answer.problems,
            .transaction = editor.last_answer.transaction,
            .notes = editor.last_answer.notes,
            .edit_group = editor.edit_group,
            .edit_group_transaction = editor.edit_group_transaction};
}

EditorRecord restored(const wire::RecordedEditor& from) {
    EditorRecord editor{.number = from.number, .user = from.user, .key = from.key};
    editor.ids = {from.first_id, from.id_count};
    editor.last_sequence = from.last_sequence;
    editor.last_answer = {.accepted = from.accepted,
                          .problems = from.problems,
                          .transaction = from.transaction,
                          .notes = from.notes};
    editor.edit_group = from.edit_group;
    editor.edit_group_transaction = from.edit_group_transaction;
    return editor;
}

std::vector<scene::BlobRef> referenced_blobs(const AuthorityState& state) {
    std::vector<scene::BlobRef> blobs = scene::referenced_blobs(state.scene);
    for (const Transaction& transaction : state.history) {
        for (const auto& [id, change] : transaction.changes.all()) {
            for (const auto& object : {change.object.before, change.object.after}) {
                if (!object) continue;
                for (const scene::BlobRef& blob : scene::referenced_blobs(*object)) blobs.push_back(blob);
            }
        }
    }
    return blobs;
}

wire::CheckpointState recorded(const AuthorityState& state) {
    wire::CheckpointState to{.scene = scene::snapshot(state.scene),
                             .last_transaction = state.last_transaction};
    WriterList writers;
    state.writers.for_each([&](ObjectId id, const ObjectWriters& fields) {
        to.objects.push_back({id, writers.fields(fields)});
    });
    for (const Transaction& transaction : state.history)
        to.transactions.push_back(recorded(transaction, writers));
    for (const EditorRecord& editor : state.editors) to.editors.push_back(recorded(editor));
    to.writers = writers.take();
    return to;
}

Expected<AuthorityState> restored(wire::CheckpointState&& from) {
    AuthorityState state;
    if (auto applied = state.scene.apply(from.scene); !applied) return tl::unexpected(applied.error());
    if (const auto problems = scene::validate(state.scene); !problems.empty())
        return failure(ErrorCode::InvalidInput, "its scene is not valid: " + problems[0].message);
    std::vector<WriterPtr> writers;
    for (wire::RecordedWriter& writer : from.writers) {
        writers.push_back(std::make_shared<const Writer>(
            Writer{writer.transaction, std::move(writer.name), std::move(writer.user), writer.time}));
    }
    for (const wire::RecordedObjectWriters& object : from.objects)
        state.writers.set(object.object, restored(object.fields, writers));
    for (wire::RecordedTransaction& transaction : from.transactions)
        state.history.push_back(restored(transaction, writers));
    for (const wire::RecordedEditor& editor : from.editors) state.editors.push_back(restored(editor));
    state.last_transaction = from.last_transaction;
    return state;
}

}  // namespace tessera::master
