#pragma once

#include <string>

#include "master/editors.h"
#include "mediator/scene/change_list.h"

namespace tessera::master {

// An accepted edit on its way to become a transaction: all that is needed to do it again after a restart.
struct RecordedEdit {
    std::uint64_t editor = 0;  // 0: the master's own (the render origin); it is no transaction
    std::uint64_t sequence = 0, gesture = 0;
    std::uint64_t undo = 0;  // the number of the transaction that it takes back; 0 = none
    std::string name, user;
    std::int64_t time = 0;
    std::vector<scene::Entry> entries;  // as they were applied; of an undo, too
    std::uint64_t transaction = 0;
    Hash128 state_hash;  // of the head with it
    std::string text;    // what it does, for people
};

// Told of everything that a restarted master must know again, before anybody else is. What it
// fails to keep does not happen.
class EditRecorder {
  public:
    virtual ~EditRecorder() = default;
    virtual Expected<void> joined(const EditorRecord& editor) = 0;
    virtual Expected<void> edited(const RecordedEdit& edit) = 0;
    virtual void cleared() = 0;  // the scene was closed; cannot be refused
};

}  // namespace tessera::master
