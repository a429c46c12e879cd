#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "mediator/base/description.h"
#include "mediator/frame/film_tile.h"
#include "mediator/frame/render_revision.h"
#include "mediator/scene/change_list.h"
#include "mediator/session/jobs.h"
#include "mediator/session/view_request.h"

// Records of a session folder as plain values: see master/scene/journal.h and master/scene/checkpoint_file.h for their
// meaning, journal_codec.h for the encoding.
namespace tessera::wire {

inline constexpr std::size_t MaxRecorded = 16'000'000;  // entries of a list that is decoded

struct RecordedEditor {
    std::uint64_t number = 0;  // never reused
    std::string user;
    std::uint64_t key = 0;
    std::uint64_t first_id = 0, id_count = 0;
    // The answer to the last edit; absent if there was no edit.
    std::uint64_t last_sequence = 0;
    bool accepted = false;
    std::vector<std::string> problems;
    std::uint64_t transaction = 0;
    std::vector<std::string> notes;
    std::uint64_t edit_group = 0, edit_group_transaction = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "number", &RecordedEditor::number), row(2, "user", &RecordedEditor::user),
                          row(3, "key", &RecordedEditor::key, FullWidth{}),
                          row(4, "first_id", &RecordedEditor::first_id),
                          row(5, "id_count", &RecordedEditor::id_count),
                          row(6, "last_sequence", &RecordedEditor::last_sequence),
                          row(7, "accepted", &RecordedEditor::accepted),
                          row(8, "problems", &RecordedEditor::problems, Limit{MaxRecorded}),
                          row(9, "transaction", &RecordedEditor::transaction),
                          row(10, "notes", &RecordedEditor::notes, Limit{MaxRecorded}),
                          row(11, "edit_group", &RecordedEditor::edit_group),
                          row(12, "edit_group_transaction", &RecordedEditor::edit_group_transaction));
    }
};

// An accepted edit: everything needed to replay it after a restart.
struct RecordedEdit {
    std::uint64_t editor = 0;  // 0: by the master (the render origin); not a transaction
    std::uint64_t sequence = 0, edit_group = 0;
    std::uint64_t undo = 0;  // the number of the transaction that it takes back; 0 = none
    std::string name, user;
    std::int64_t time = 0;              // ns since 1970
    std::vector<scene::Entry> entries;  // as applied, also of an undo
    std::uint64_t transaction = 0;      // the transaction it belongs to
    Hash128 state_hash;                 // of the head after it
    std::string text;                   // readable summary
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "editor", &RecordedEdit::editor), row(2, "sequence", &RecordedEdit::sequence),
            row(3, "edit_group", &RecordedEdit::edit_group), row(4, "undo", &RecordedEdit::undo),
            row(5, "name", &RecordedEdit::name), row(6, "user", &RecordedEdit::user),
            row(7, "time", &RecordedEdit::time),
            row(8, "entries", &RecordedEdit::entries, Limit{scene::MaxEntries}),
            row(9, "transaction", &RecordedEdit::transaction),
            row(10, "state_hash", &RecordedEdit::state_hash), row(11, "text", &RecordedEdit::text));
    }
};

// The one editor of an exclusive scene.
struct RecordedOwner {
    std::string user;
    std::uint64_t key = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "user", &RecordedOwner::user),
                          row(2, "key", &RecordedOwner::key, FullWidth{}));
    }
};
struct RecordedTitle {
    std::string title;
    std::optional<RecordedOwner> owner;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "title", &RecordedTitle::title), row(2, "owner", &RecordedTitle::owner));
    }
};
struct RecordedClose {  // resets to the empty scene, without editors
    static constexpr auto describe(auto) { return std::tuple(); }
};

struct RecordedWriter {
    std::uint64_t transaction = 0;
    std::string name, user;
    std::int64_t time = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "transaction", &RecordedWriter::transaction),
                          row(2, "name", &RecordedWriter::name), row(3, "user", &RecordedWriter::user),
                          row(4, "time", &RecordedWriter::time));
    }
};
struct RecordedFieldWriter {
    std::uint32_t field = 0;
    std::uint64_t writer = 0;  // index in CheckpointState::writers, from 1; 0 = none
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "field", &RecordedFieldWriter::field),
                          row(2, "writer", &RecordedFieldWriter::writer));
    }
};
struct RecordedObjectWriters {
    ObjectId object;
    std::vector<RecordedFieldWriter> fields;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "object", &RecordedObjectWriters::object),
                          row(2, "fields", &RecordedObjectWriters::fields, Limit{scene::MaxFields}));
    }
};
struct RecordedChange {
    ObjectId object;
    scene::FieldMask mask = 0;
    std::optional<scene::Object> before,
        after;  // if both exist: only the fields of the mask and the name
    std::vector<RecordedFieldWriter> writers_before, writers_after;
    // Converts a state to and from an entry, an update or a creation; a removal has no state.
    std::optional<scene::Entry> entry(const std::optional<scene::Object>& state) const;
    static std::optional<scene::Object> state(std::optional<scene::Entry>&& entry);
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "object", &RecordedChange::object), row(2, "mask", &RecordedChange::mask),
            row(3, "before",
                Computed{[](const RecordedChange& change) { return change.entry(change.before); },
                         [](RecordedChange& change, std::optional<scene::Entry>&& entry) {
                             change.before = state(std::move(entry));
                         }}),
            row(4, "after",
                Computed{[](const RecordedChange& change) { return change.entry(change.after); },
                         [](RecordedChange& change, std::optional<scene::Entry>&& entry) {
                             change.after = state(std::move(entry));
                         }}),
            row(5, "writers_before", &RecordedChange::writers_before, Limit{scene::MaxFields}),
            row(6, "writers_after", &RecordedChange::writers_after, Limit{scene::MaxFields}));
    }
};
struct RecordedTransaction {
    std::uint64_t number = 0, editor = 0;
    std::uint32_t nature = 0;
    std::uint64_t author = 0;  // as RecordedFieldWriter::writer
    std::uint64_t edit_group = 0;
    std::uint32_t edits = 0;
    std::uint64_t undoes = 0, undone_by = 0;
    std::string text;
    std::vector<RecordedChange> changes;
    static constexpr auto describe(auto row) {
        using Self = RecordedTransaction;
        return std::tuple(row(1, "number", &Self::number), row(2, "editor", &Self::editor),
                          row(3, "nature", &Self::nature), row(4, "author", &Self::author),
                          row(5, "edit_group", &Self::edit_group), row(6, "edits", &Self::edits),
                          row(7, "undoes", &Self::undoes), row(8, "undone_by", &Self::undone_by),
                          row(9, "text", &Self::text),
                          row(10, "changes", &Self::changes, Limit{MaxRecorded}));
    }
};

// Samples of pixels of a tile that an adaptive view gets in its current step.
struct SavedPart {
    Rect tile;
    frame::SampleBlock block;
    std::string mask;  // as view::WorkUnit::mask
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "tile", &SavedPart::tile), row(2, "block", &SavedPart::block),
                          row(3, "mask", &SavedPart::mask));
    }
};

// A view and its film.
struct SavedView {
    std::string name, owner_user;
    std::uint64_t owner_key = 0, number = 0;
    session::ViewRequest request;
    Hash128 scene_hash_of_film;
    std::string kind;         // of the nodes that rendered its blocks, if the view is reproducible
    std::uint64_t films = 0;  // begun for the view, that of the blocks included
    std::vector<frame::FilmTile> blocks;
    std::uint64_t block_count = 0;  // when decoded: the number of blocks that follow in the file
    std::uint32_t steps = 0;        // of an adaptive view: decided ones
    std::vector<SavedPart> step;    // the last one: a part of it may be in the blocks
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "name", &SavedView::name), row(2, "owner_user", &SavedView::owner_user),
            row(3, "owner_key", &SavedView::owner_key, FullWidth{}), row(4, "number", &SavedView::number),
            // For folders written before view requests were stored.
            row(5, "view",
                Computed{[](const SavedView&) { return std::optional<view::View>(); },
                         [](SavedView& saved, std::optional<view::View>&& view) {
                             saved.request.view = std::move(*view);
                         }}),
            row(6, "spp",
                Computed{[](const SavedView&) { return std::uint64_t{0}; },
                         [](SavedView& saved, std::uint64_t spp) {
                             if (spp != 0) saved.request.stop.spp = spp;
                         }}),
            row(7, "scene_hash_of_film", &SavedView::scene_hash_of_film),
            row(8, "blocks",
                Computed{[](const SavedView& view) {
                             return std::max<std::uint64_t>(view.blocks.size(), view.block_count);
                         },
                         [](SavedView& view, std::uint64_t count) { view.block_count = count; }}),
            row(9, "request", &SavedView::request), row(10, "kind", &SavedView::kind),
            row(11, "films", &SavedView::films), row(12, "steps", &SavedView::steps),
            row(13, "step", &SavedView::step, Limit{MaxRecorded}));
    }
};

// A job was submitted: its view, without film.
struct RecordedJob {
    SavedView view;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "view", &RecordedJob::view)); }
};
// A job has ended or was cancelled.
struct RecordedJobEnd {
    session::JobName job;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "job", &RecordedJobEnd::job)); }
};

using JournalRecord =
    std::variant<RecordedEditor, RecordedEdit, RecordedTitle, RecordedClose, RecordedJob, RecordedJobEnd>;
constexpr auto alternatives(const JournalRecord*) {
    return std::tuple(Alternative<RecordedEditor>{1, "joined"}, Alternative<RecordedEdit>{2, "edit"},
                      Alternative<RecordedTitle>{3, "title"}, Alternative<RecordedClose>{4, "closed"},
                      Alternative<RecordedJob>{5, "job_started"},
                      Alternative<RecordedJobEnd>{6, "job_ended"});
}

struct CheckpointState {
    std::uint64_t journal = 0;  // the first segment that is not included
    std::string title;
    scene::ChangeList scene;  // a snapshot
    std::uint64_t last_transaction = 0;
    std::vector<RecordedWriter> writers;
    std::vector<RecordedObjectWriters> objects;
    std::vector<RecordedTransaction> transactions;  // oldest first
    std::vector<RecordedEditor> editors;
    std::vector<SavedView> views;                           // encoded without their blocks
    std::uint32_t render_revision = frame::RenderRevision;  // of the blocks; 0: older than render revisions
    std::optional<RecordedOwner> owner;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "journal", &CheckpointState::journal),
                          row(2, "title", &CheckpointState::title), row(3, "scene", &CheckpointState::scene),
                          row(4, "last_transaction", &CheckpointState::last_transaction),
                          row(5, "writers", &CheckpointState::writers, Limit{MaxRecorded}),
                          row(6, "objects", &CheckpointState::objects, Limit{MaxRecorded}),
                          row(7, "transactions", &CheckpointState::transactions, Limit{MaxRecorded}),
                          row(8, "editors", &CheckpointState::editors, Limit{MaxRecorded}),
                          row(9, "views", &CheckpointState::views, Limit{MaxRecorded}),
                          row(10, "render_revision", &CheckpointState::render_revision),
                          row(11, "owner", &CheckpointState::owner));
    }
};

// A finished job, in its own file; its picture follows.
struct StoredJob {
    session::JobStatus status;
    std::uint32_t width = 0, height = 0, components = 0;  // of the picture
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "status", &StoredJob::status), row(2, "width", &StoredJob::width),
                          row(3, "height", &StoredJob::height), row(4, "components", &StoredJob::components));
    }
};

}  // namespace tessera::wire
