#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "mediator/frame/film_tile.h"
#include "mediator/frame/render_revision.h"
#include "mediator/scene/change_list.h"
#include "mediator/view/view.h"

// What a session folder holds, as plain values: see master/journal.h and master/checkpoint.h for what they
// mean, journal_codec.h for the bytes.
namespace tessera::wire {

struct RecordedEditor {
    std::uint64_t number = 0;  // never given again
    std::string user;
    std::uint64_t key = 0;
    std::uint64_t first_id = 0, id_count = 0;
    // The answer to the last edit; of one who only joined there is none.
    std::uint64_t last_sequence = 0;
    bool accepted = false;
    std::vector<std::string> problems;
    std::uint64_t transaction = 0;
    std::vector<std::string> notes;
    std::uint64_t gesture = 0, gesture_transaction = 0;
};

// An accepted edit on its way to become a transaction: all that is needed to do it again after a restart.
struct RecordedEdit {
    std::uint64_t editor = 0;  // 0: the master's own (the render origin); it is no transaction
    std::uint64_t sequence = 0, gesture = 0;
    std::uint64_t undo = 0;  // the number of the transaction that it takes back; 0 = none
    std::string name, user;
    std::int64_t time = 0;              // ns since 1970
    std::vector<scene::Entry> entries;  // as they were applied; of an undo, too
    std::uint64_t transaction = 0;      // that it is, or is part of
    Hash128 state_hash;                 // of the head with it
    std::string text;                   // what it does, for people
};

struct RecordedTitle {
    std::string title;
};
struct RecordedClose {};  // back to the empty scene, nobody edits

using JournalRecord = std::variant<RecordedEditor, RecordedEdit, RecordedTitle, RecordedClose>;

struct RecordedWriter {
    std::uint64_t transaction = 0;
    std::string name, user;
    std::int64_t time = 0;
};
struct RecordedFieldWriter {
    std::uint32_t field = 0;
    std::uint64_t writer = 0;  // place in CheckpointState::writers, from 1; 0 = none
};
struct RecordedObjectWriters {
    ObjectId object;
    std::vector<RecordedFieldWriter> fields;
};
struct RecordedChange {
    ObjectId object;
    scene::FieldMask mask = 0;
    std::optional<scene::Object> before,
        after;  // only the fields of the mask and the name, where both are there
    std::vector<RecordedFieldWriter> writers_before, writers_after;
};
struct RecordedTransaction {
    std::uint64_t number = 0, editor = 0;
    std::uint32_t nature = 0;
    std::uint64_t author = 0;  // as RecordedFieldWriter::writer
    std::uint64_t gesture = 0;
    std::uint32_t edits = 0;
    std::uint64_t undoes = 0, undone_by = 0;
    std::string text;
    std::vector<RecordedChange> changes;
};

// A view and its film.
struct SavedView {
    std::string name, owner_user;
    std::uint64_t owner_key = 0, number = 0;
    view::View view;
    std::uint64_t spp = 0;
    Hash128 scene_hash_of_film;
    std::vector<frame::FilmTile> blocks;
};

struct CheckpointState {
    std::uint64_t journal = 0;  // the first segment that is not in it
    std::string title;
    scene::ChangeList scene;  // a snapshot
    std::uint64_t last_transaction = 0;
    std::vector<RecordedWriter> writers;
    std::vector<RecordedObjectWriters> objects;
    std::vector<RecordedTransaction> transactions;  // oldest first
    std::vector<RecordedEditor> editors;
    std::vector<SavedView> views;                           // encoded without their blocks
    std::uint32_t render_revision = frame::RenderRevision;  // of the blocks; 0: of before there were any
    std::vector<std::uint64_t> block_counts;
};

}  // namespace tessera::wire
