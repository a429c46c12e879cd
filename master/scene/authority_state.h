#pragma once

#include <deque>
#include <vector>

#include "master/scene/editors.h"
#include "master/scene/transaction.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

// The persistent state of the scene authority. Objects are shared with it.
struct AuthorityState {
    scene::Scene scene;  // the head
    std::uint64_t last_transaction = 0;
    std::deque<Transaction> history;
    std::vector<EditorRecord> editors;
    WriterTable writers;
};

// Of the scene and of its undo steps; each at least once.
std::vector<scene::BlobRef> referenced_blobs(const AuthorityState& state);

// In checkpoint form; the caller sets journal, title and views.
wire::CheckpointState recorded(const AuthorityState& state);
wire::RecordedEditor recorded(const EditorRecord& editor);

// Fails with InvalidInput if the scene is invalid or its hash differs from the stored one.
Expected<AuthorityState> restored(wire::CheckpointState&& state);
EditorRecord restored(const wire::RecordedEditor& editor);

}  // namespace tessera::master
