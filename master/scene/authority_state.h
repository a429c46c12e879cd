#pragma once

#include <deque>
#include <vector>

#include "master/scene/editors.h"
#include "master/scene/transaction.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

// What of the scene authority outlives its process. Objects are shared with it.
struct AuthorityState {
    scene::Scene scene;  // the head
    std::uint64_t last_transaction = 0;
    std::deque<Transaction> history;
    std::vector<EditorRecord> editors;
    WriterTable writers;
};

// As a checkpoint has it; journal, title and views are the caller's to fill.
wire::CheckpointState recorded(const AuthorityState& state);
wire::RecordedEditor recorded(const EditorRecord& editor);

// Fails with InvalidInput when the scene is not valid or its hash not the one promised.
Expected<AuthorityState> restored(wire::CheckpointState&& state);
EditorRecord restored(const wire::RecordedEditor& editor);

}  // namespace tessera::master
